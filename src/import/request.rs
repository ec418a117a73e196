//! The topic that the user requests.

/// The topic that the user requests.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum TopicRequest {
    /// The best one.
    #[default]
    Any,
    /// No topic.
    Without,
    /// This one.
    Named(String),
}
