//! Options from a JavaScript object. Unknown keys and wrong kinds of value are errors that name the key.

use super::error::{Fallible, invalid_option};
use crate::deformation::{DeformationMethod, DeformationOptions, Material, UntanglingOptions};
use crate::gini::GiniOptions;
use crate::lim::LimOptions;
use crate::mixed_integer::MixedIntegerOptions;
use crate::newton::NewtonOptions;
use crate::parameterization::ParameterizationOptions;
use js_sys::{Object, Reflect};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use tsify::Tsify;
use wasm_bindgen::prelude::*;

/// Options of a deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "camelCase", default)]
pub struct DeformationSettings {
    /// The elastic energy.
    #[tsify(type = "Material")]
    pub energy: String,
    /// Young's modulus, > 0, in any unit of pressure; of the materials that have one.
    pub young: f64,
    /// Poisson's ratio, below 0.5.
    pub poisson: f64,
    /// The method.
    pub method: DeformationMethod,
    /// How hard targets pull at free vertices, relative to how hard the body holds on to them.
    pub target_stiffness: f64,
    /// Stop when |ΔE|/(|E| + floor), or the gradient against the body's stiffness and size, is below
    /// this. The floor is the energy of a strain of 1.1e-4 all over: units do not matter.
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
}

impl Default for DeformationSettings {
    fn default() -> Self {
        let options = DeformationOptions::default();
        Self {
            energy: Material::NAMES[0].into(),
            young: Material::YOUNG,
            poisson: Material::POISSON,
            method: options.method,
            target_stiffness: options.target_stiffness,
            tolerance: options.tolerance,
            max_iterations: options.max_iterations,
        }
    }
}

/// Options of untangling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "camelCase", default)]
pub struct UntangleSettings {
    /// What is kept low on the way; the neo-Hookean ones are for solids.
    #[tsify(type = "UntangleEnergy")]
    pub energy: String,
    /// Young's modulus, > 0, in any unit of pressure; of the energies that have one.
    pub young: f64,
    /// Poisson's ratio, below 0.5.
    pub poisson: f64,
    /// Most iterations of L-BFGS-B on the dual problem in one step.
    pub max_qp_iterations: usize,
    /// Most iterations of the polisher in one step.
    pub max_polish_iterations: usize,
    /// η, the least measure of an element in units of that at rest, before it is reduced where there is no room.
    pub offset: f64,
    /// How hard targets pull at free vertices, relative to how hard the body holds on to the one it holds on to most.
    /// Where it is left out and `overlap` is set: 1e-5.
    pub target_stiffness: f64,
    /// Stop after this many steps.
    pub max_iterations: usize,
    /// Keep the boundary from passing through itself? That of the start must not meet itself (or see `flow`). Pins with
    /// targets then move there along a path that is free.
    pub overlap: bool,
    /// With `overlap`: the start's boundary is where the boundary is wanted, and may meet itself. There it is first
    /// parted by mean curvature flow (in the plane by a flow of its curvature), then every vertex of it that has no
    /// target is pulled back, softly. Pins go back to where they are in the start.
    pub flow: bool,
    /// η of contacts, relative to the body's size.
    pub contact_offset: f64,
    /// With `overlap`: end where no vertex has moved by more than this in a step, or on average over ten, relative to the
    /// body's size. Where it is left out and `overlap` is set: 1e-3.
    pub settle: f64,
    /// Then lower the energy (not of arap and dirichlet, whose minima fold) by Newton's method? It keeps all elements
    /// positive and, with `overlap`, the boundary from meeting itself.
    pub minimize: bool,
    /// With `minimize`: stop when the energy changes by less than this part in a step.
    pub tolerance: f64,
}

impl UntangleSettings {
    fn usual(overlap: bool) -> Self {
        let options = match overlap {
            true => GiniOptions::overlap(),
            false => GiniOptions::default(),
        };
        Self {
            energy: "arap".into(),
            young: Material::YOUNG,
            poisson: Material::POISSON,
            max_qp_iterations: options.max_qp_iterations,
            max_polish_iterations: options.max_polish_iterations,
            offset: options.offset,
            target_stiffness: options.target_stiffness,
            max_iterations: options.max_iterations,
            overlap: options.overlap,
            flow: false,
            contact_offset: options.contact_offset,
            settle: options.settle,
            minimize: false,
            tolerance: 1e-6,
        }
    }
}

impl Default for UntangleSettings {
    fn default() -> Self {
        Self::usual(false)
    }
}

/// The material, the options, and whether the start's boundary is to flow. `undefined` and `null` stand for the defaults.
pub(super) fn untangle_options(value: &JsValue) -> Fallible<(Material, UntanglingOptions, bool)> {
    let settings: UntangleSettings = options(value)?;
    let material = Material::named(&settings.energy, settings.young, settings.poisson);
    let Some(material) = material.filter(|_| UNTANGLE_ENERGIES.contains(&&*settings.energy)) else {
        let names = UNTANGLE_ENERGIES.join(", ");
        return Err(invalid_option("energy", &format!("there are {names}")));
    };
    let usual = match settings.overlap {
        true => GiniOptions::overlap(),
        false => GiniOptions::default(),
    };
    let given = |name: &str, value_of: f64, otherwise: f64| -> Fallible<f64> {
        let set = value.is_object() && !Reflect::get(value, &name.into())?.is_undefined();
        Ok(if set { value_of } else { otherwise })
    };
    let stiffness = settings.target_stiffness;
    let gini = GiniOptions {
        max_qp_iterations: settings.max_qp_iterations,
        max_polish_iterations: settings.max_polish_iterations,
        offset: settings.offset,
        target_stiffness: given("targetStiffness", stiffness, usual.target_stiffness)?,
        max_iterations: settings.max_iterations,
        overlap: settings.overlap,
        contact_offset: settings.contact_offset,
        settle: given("settle", settings.settle, usual.settle)?,
    };
    let minimize = settings.minimize.then(|| NewtonOptions {
        tolerance: settings.tolerance,
        max_iterations: settings.max_iterations,
        ..Default::default()
    });
    let options = UntanglingOptions { gini, minimize };
    Ok((material, options, settings.flow))
}

/// Energies that can be kept low while untangling.
const UNTANGLE_ENERGIES: [&str; 5] = [
    "arap",
    "neo-hookean",
    "stable-neo-hookean",
    "symmetric-dirichlet",
    "dirichlet",
];

/// `undefined` and `null` stand for the defaults.
pub(super) fn parameterization_options(value: &JsValue) -> Fallible<ParameterizationOptions> {
    options(value)
}

/// The options of locally injective mappings, if `method` says `lim`, or is left out where that is `usual`: their
/// own energies, and nothing of materials.
pub(super) fn lim_options(value: &JsValue, usual: bool) -> Fallible<Option<LimOptions>> {
    let Some(object) = value.dyn_ref::<Object>() else {
        let absent = value.is_undefined() || value.is_null();
        return Ok((absent && usual).then(LimOptions::default));
    };
    let method = Reflect::get(object, &"method".into())?;
    if method.is_undefined() && !usual || !method.is_undefined() && method != "lim" {
        return Ok(None);
    }
    let others = Object::assign(&Object::new(), object);
    Reflect::delete_property(&others, &"method".into())?;
    options(&others).map(Some)
}

/// `undefined` and `null` stand for the defaults.
pub(super) fn deformation_options(value: &JsValue) -> Fallible<DeformationOptions> {
    let settings: DeformationSettings = options(value)?;
    let Some(material) = Material::named(&settings.energy, settings.young, settings.poisson) else {
        let names = Material::NAMES.join(", ");
        return Err(invalid_option("energy", &format!("there are {names}")));
    };
    Ok(DeformationOptions {
        material,
        method: settings.method,
        target_stiffness: settings.target_stiffness,
        tolerance: settings.tolerance,
        max_iterations: settings.max_iterations,
    })
}

/// `undefined` and `null` stand for the defaults.
pub(super) fn mixed_integer_options(value: &JsValue) -> Fallible<MixedIntegerOptions> {
    options(value)
}

fn options<T: Default + Serialize + DeserializeOwned>(value: &JsValue) -> Fallible<T> {
    if value.is_undefined() || value.is_null() {
        return Ok(T::default());
    }
    let defaults = serde_wasm_bindgen::to_value(&T::default()).map_err(JsValue::from)?;
    let given = checked(value, defaults, &|value| read::<T>(value).map(|_| ()))?;
    read(given).map_err(|what| invalid_option("options", &what))
}

/// The object without what is undefined, if all its keys are those of `defaults` and `fits` takes each alone.
// Apart from `options`, which is compiled once for every kind of options.
fn checked(
    value: &JsValue,
    defaults: JsValue,
    fits: &dyn Fn(JsValue) -> Result<(), String>,
) -> Fallible<JsValue> {
    let Some(object) = value.dyn_ref::<Object>() else {
        return Err(invalid_option("options", "an object is needed"));
    };
    // serde-wasm-bindgen reads only the fields a struct has, so the keys are compared here.
    let known = Object::keys(&defaults.into());
    let given = Object::new();
    for key in Object::keys(object) {
        let value = Reflect::get(object, &key)?;
        if value.is_undefined() {
            continue;
        }
        let name = key.as_string().unwrap_or_default();
        if !known.includes(&key, 0) {
            let names: Vec<_> = known.iter().filter_map(|key| key.as_string()).collect();
            let what = format!("there is no such option; there are {}", names.join(", "));
            return Err(invalid_option(&name, &what));
        }
        let alone = Object::new();
        Reflect::set(&alone, &key, &value)?;
        fits(alone.into()).map_err(|what| invalid_option(&name, &what))?;
        Reflect::set(&given, &key, &value)?;
    }
    Ok(given.into())
}

fn read<T: DeserializeOwned>(value: JsValue) -> Result<T, String> {
    serde_wasm_bindgen::from_value(value).map_err(|error| error.to_string())
}

/// The default options of a parameterization as a JavaScript object.
#[wasm_bindgen(js_name = defaultOptions, unchecked_return_type = "ParameterizationOptions")]
pub fn default_options() -> Fallible<JsValue> {
    serde_wasm_bindgen::to_value(&ParameterizationOptions::default()).map_err(JsValue::from)
}

/// The default options of a deformation.
#[wasm_bindgen(js_name = defaultDeformationOptions, unchecked_return_type = "DeformationSettings")]
pub fn default_deformation_options() -> Fallible<JsValue> {
    serde_wasm_bindgen::to_value(&DeformationSettings::default()).map_err(JsValue::from)
}

/// The default options of a deformation by locally injective mappings.
#[wasm_bindgen(js_name = defaultLimOptions, unchecked_return_type = "LimOptions")]
pub fn default_lim_options() -> Fallible<JsValue> {
    serde_wasm_bindgen::to_value(&LimOptions::default()).map_err(JsValue::from)
}

/// The default options of untangling, with `overlap` or without.
#[wasm_bindgen(js_name = defaultUntangleOptions, unchecked_return_type = "UntangleSettings")]
pub fn default_untangle_options(overlap: Option<bool>) -> Fallible<JsValue> {
    let settings = UntangleSettings::usual(overlap.unwrap_or(false));
    serde_wasm_bindgen::to_value(&settings).map_err(JsValue::from)
}

/// The default options of a mixed-integer problem.
#[wasm_bindgen(js_name = defaultMixedIntegerOptions, unchecked_return_type = "MixedIntegerOptions")]
pub fn default_mixed_integer_options() -> Fallible<JsValue> {
    serde_wasm_bindgen::to_value(&MixedIntegerOptions::default()).map_err(JsValue::from)
}

#[wasm_bindgen(typescript_custom_section)]
const MATERIAL_TYPE: &str = "
/** An elastic energy. */
export type Material =
  'neo-hookean' | 'stable-neo-hookean' | 'st-venant-kirchhoff' | 'arap' | 'symmetric-dirichlet' | 'dirichlet';

/** An energy that can be kept low while untangling. */
export type UntangleEnergy = 'arap' | 'neo-hookean' | 'stable-neo-hookean' | 'symmetric-dirichlet' | 'dirichlet';

/** Options of locally injective mappings, chosen by `method: 'lim'`. */
export type LimSettings = Partial<LimOptions> & { method?: 'lim' };
";
