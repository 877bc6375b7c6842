//! `foldfree miqp`: solutions, reports, and one line for everything that can be wrong.
#![cfg(feature = "cli")]

mod cli_support;

use cli_support::Folder;
use serde_json::Value;

const GCD: &str =
    "3 1 3 3 4\n0 0 1\n1 1 1\n2 2 1\n0.3 0.4 0.2\n0 0 6\n0 1 10\n0 2 15\n0 3 -1\n0 1 2\n";
const DUPLICATE: &str =
    "2 2 1 2 6\n0 0 1\n1 1 1\n0.3 0.4\n0 0 1\n0 1 1\n0 2 -1\n1 0 2\n1 1 2\n1 2 -2\n0\n";

#[test]
fn every_rounding_writes_a_solution_and_a_report() {
    let folder = Folder::new("miqp");
    folder.write("a.sys", GCD);
    for rounding in ["direct", "greedy", "two-opt", "lattice"] {
        let line = format!("miqp a.sys --rounding {rounding} --out x.txt --report r.json");
        let ran = folder.foldfree(&line).ends(0);
        assert!(ran.stdout.contains("above the relaxed"), "{ran:#?}");
        assert_eq!(folder.read("x.txt"), b"1\n1\n-1\n");
        let report: Value = serde_json::from_slice(&folder.read("r.json")).expect("JSON");
        assert_eq!(report["status"], "converged");
        assert_eq!(report["options"]["rounding"], rounding);
        assert_eq!(report["reduced_integers"], 2);
        assert_eq!(report["rows"][0]["outcome"], "eliminates");
        let number = |key: &str| report[key].as_f64().unwrap_or(f64::NAN);
        assert!((number("energy") - 1.0).abs() < 1e-12, "{report:#}");
        assert!(number("relaxed_energy") < number("energy"));
        assert!(number("seconds") >= number("setup_seconds") && number("setup_seconds") > 0.0);
        assert_eq!(number("violation"), 0.0);
        assert_eq!(report["proven"], rounding == "lattice");
        assert_eq!(report["lower_bound"].is_number(), rounding == "lattice");
        let steps = report["iterations"].as_array().expect("steps");
        assert_eq!(steps[0]["kind"], "relax");
        assert!(steps.len() > 1);
    }
    folder
        .foldfree("miqp a.sys --quiet --repeat 5 --engine three-level")
        .ends(0);
}

#[test]
fn gzipped_problems_are_read_and_redundant_rows_are_said() {
    use std::io::Write;
    let folder = Folder::new("miqp-gz");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(DUPLICATE.as_bytes()).expect("memory");
    folder.write("a.sys.gz", packed.finish().expect("memory"));
    let ran = folder.foldfree("miqp a.sys.gz --out x.txt").ends(0);
    assert!(
        ran.stdout.contains("constraint row 1 is implied by others"),
        "{ran:#?}"
    );
    assert_eq!(folder.read("x.txt"), b"0\n1\n");
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let folder = Folder::new("miqp-bad");
    folder.write(
        "infeasible.sys",
        "2 1 2 2 3\n0 0 1\n1 1 1\n0.3 0.4\n0 0 2\n0 1 4\n0 2 -3\n0 1\n",
    );
    folder.write("contradiction.sys", DUPLICATE.replace("1 2 -2", "1 2 -3"));
    folder.write("line.sys", GCD.replace("0 2 15", "0 2 x"));
    folder.write("flat.sys", "1 0 0 0 0\n1\n");
    folder.write("good.sys", GCD);
    let fails = |line: &str, words: &[&str]| folder.foldfree(line).fails(words);
    fails(
        "miqp infeasible.sys",
        &["infeasible.sys", "row 0 has no integer solution"],
    );
    fails("miqp contradiction.sys", &["row 1 contradicts"]);
    fails("miqp line.sys", &["line.sys: line 8", "\"x\""]);
    fails("miqp flat.sys", &["not positive definite", "unknown 0"]);
    fails("miqp none.sys", &["none.sys"]);
    fails("miqp good.sys --rounding nearest", &["nearest"]);
    fails(
        "miqp good.sys --rounding lattice --engine three-level",
        &["engine", "dense"],
    );
    fails("miqp good.sys --budget 0.7", &["budget"]);
    fails("miqp good.sys --out none/x.txt", &["folder does not exist"]);
}
