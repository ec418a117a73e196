//! Instances for the unit tests.

use super::calls::Interface;
use super::instance::{Instance, Purpose};
use super::logger::Logger;
use crate::declaration::{Configuration, Naming};

/// A configuration with these effects in its resources.
pub(super) fn with_effects(effects: &str) -> Configuration {
    let read = |file: &str| Ok((file == "effects.json").then(|| effects.to_owned()));
    Configuration::from_resources(read).unwrap()
}

/// An instance without a log.
pub(super) fn instance(interface: Interface, configuration: Configuration) -> Instance {
    with_logger(Logger::fmi2(None, c"test", false), interface, configuration)
}

pub(super) fn with_logger(
    logger: Logger,
    interface: Interface,
    configuration: Configuration,
) -> Instance {
    let purpose = Purpose {
        interface,
        naming: Naming::Scalars,
        has_events: false,
    };
    Instance::new(logger, purpose, configuration)
}

/// An instance with these effects whose initialization is over.
pub(super) fn running(interface: Interface, effects: &str) -> Instance {
    let mut instance = instance(interface, with_effects(effects));
    instance.enter_initialization().unwrap();
    instance.exit_initialization().unwrap();
    instance
}
