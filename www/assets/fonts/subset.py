"""Cuts Inter (SIL OFL 1.1, https://github.com/rsms/inter) down to what the page writes.

Usage: python subset.py Inter-Regular.otf Inter-Medium.otf   (needs fonttools)
The digits are replaced by the tabular ones, as egui knows no font features.
"""
import sys
from pathlib import Path
from fontTools import subset
from fontTools.ttLib import TTFont

UNICODES = [*range(0x20, 0x7F), *range(0xA0, 0x100), *range(0x391, 0x3CA), 0x131,
            0x2013, 0x2014, 0x2016, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2026, 0x2032,
            *range(0x2070, 0x209D), 0x1D62, *range(0x2190, 0x2196), 0x2212, 0x221E, 0x2248,
            0x2260, 0x2264, 0x2265, 0x25A0, 0x25B2, 0x25B6, 0x25BC, 0x25C0, 0x25CF, 0x2713, 0x2715]


def tabular(font):
    """Digit glyph name → tabular glyph name, from the font's own `tnum` feature."""
    gsub = font["GSUB"].table
    found = {}
    for record in gsub.FeatureList.FeatureRecord:
        if record.FeatureTag == "tnum":
            for index in record.Feature.LookupListIndex:
                for table in gsub.LookupList.Lookup[index].SubTable:
                    table = getattr(table, "ExtSubTable", table)
                    found.update(getattr(table, "mapping", {}))
    return found


for path in map(Path, sys.argv[1:]):
    font = TTFont(path)
    swap = tabular(font)
    for table in font["cmap"].tables:
        if table.isUnicode():
            for code in [*range(0x30, 0x3A), 0x2212, 0x2B]:
                name = table.cmap.get(code)
                if name in swap:
                    table.cmap[code] = swap[name]
    options = subset.Options()
    options.layout_features = ["kern"]
    options.name_IDs = ["*"]
    cutter = subset.Subsetter(options)
    cutter.populate(unicodes=UNICODES)
    cutter.subset(font)
    out = Path(__file__).with_name(path.name)
    font.save(out)
    print(out.name, out.stat().st_size, "bytes,", sum(c in swap for c in swap), "tabular forms known")
