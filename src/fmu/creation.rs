//! Creation of instances, and the choice of their log categories.

use super::calls::Interface;
use super::guard::{into_component, panic_message};
use super::instance::{Instance, Outcome, Purpose, refuse};
use super::logger::Logger;
use super::resources;
use super::status::Status;
use crate::declaration::{Configuration, LOG_CATEGORIES, guid};
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A string that C hands over.
///
/// # Safety
/// `string` is null or ends in a zero byte and lives as long as the result is used.
pub(super) unsafe fn text<'a>(string: *const c_char) -> Outcome<&'a CStr> {
    if string.is_null() {
        return refuse("a string is a null pointer");
    }
    // SAFETY: not null; the caller promises the rest.
    Ok(unsafe { CStr::from_ptr(string) })
}

/// Identity and location of the unpacked FMU, as the importer passes them.
pub(super) struct Package {
    /// The standard's name for the identity of the model description.
    pub identity_name: &'static str,
    pub identity: *const c_char,
    pub resources: *const c_char,
}

/// Creates an instance for a purpose. On failure it logs the reason and returns null.
///
/// # Safety
/// The strings of `package` are null or end in zero.
pub(super) unsafe fn create(
    function: &str,
    logger: Logger,
    purpose: Result<Purpose, String>,
    package: &Package,
) -> *mut c_void {
    let created = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the caller's promise.
        let (identity, location) = unsafe { (text(package.identity), text(package.resources)) };
        let name = package.identity_name;
        let Ok(identity) = identity else {
            return Err(format!("the {name} is a null pointer"));
        };
        let purpose = purpose?;
        let location = location.unwrap_or(c"");
        let configuration = configure(&logger, purpose.interface, (name, identity), location)?;
        Ok((purpose, configuration))
    }));
    let message = match created {
        Ok(Ok((purpose, configuration))) => {
            return into_component(Instance::new(logger, purpose, configuration));
        }
        Ok(Err(message)) => message,
        Err(panic) => panic_message(panic.as_ref()).to_owned(),
    };
    logger.report(Status::Error, &format!("{function}: {message}"));
    std::ptr::null_mut()
}

/// The configuration in the resources, checked against the identity that the importer passes.
fn configure(
    logger: &Logger,
    interface: Interface,
    (identity_name, expected): (&str, &CStr),
    location: &CStr,
) -> Result<Configuration, String> {
    let location = location
        .to_str()
        .map_err(|_| "the resource location is not UTF-8".to_owned())?;
    let folder = resources::folder(location)?;
    let configuration = match &folder {
        Some(folder) if folder.is_dir() => {
            Configuration::from_resources(|file| resources::read(folder, file))
                .map_err(|error| error.to_string())?
        }
        Some(folder) => {
            let folder = folder.display();
            logger.report(
                Status::Warning,
                &format!("{folder} is no folder; the built-in vehicle and terrains are used"),
            );
            Configuration::default()
        }
        None => Configuration::default(),
    };
    let actual = guid(&configuration);
    let expected = expected.to_string_lossy();
    if expected.trim_matches(['{', '}']) != actual {
        return Err(format!(
            "the model description's {identity_name} {expected} is not {actual}, the one of this library with these \
             resources; package the FMU anew with \"ugv package\""
        ));
    }
    let alone = configuration.for_co_simulation_alone();
    if interface == Interface::ModelExchange && !alone.is_empty() {
        return Err(format!(
            "this FMU supports co-simulation only: with {} its model has states or events that model exchange does not have",
            alone.join(", ")
        ));
    }
    Ok(configuration)
}

/// Chooses the log categories of an instance by their names.
///
/// # Safety
/// Each of `categories` is null or ends in zero.
pub(super) unsafe fn set_logging(
    instance: &mut Instance,
    on: bool,
    categories: &[*const c_char],
) -> Outcome {
    let mut named = [false; LOG_CATEGORIES.len()];
    for &category in categories {
        // SAFETY: the caller's promise.
        let name = unsafe { text(category) }?;
        match LOG_CATEGORIES.iter().position(|known| known.name == name) {
            Some(index) => named[index] = true,
            None => {
                let known = LOG_CATEGORIES
                    .iter()
                    .map(|known| known.name.to_string_lossy());
                let known: Vec<_> = known.collect();
                return refuse(format!("the log categories are {}", known.join(", ")));
            }
        }
    }
    instance.logger.choose(on, named);
    Ok(())
}
