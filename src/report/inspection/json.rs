//! As JSON (format `ugv-inspection/1`), in SI units and radians.

use super::words::quality;
use crate::inspection::{ChannelReport, Delay, Doubt, Inspection, MotionSummary, Noise, Timing};
use crate::recording::IntervalEstimate;
use crate::recording::{Note, Recording};
use serde_json::{Value, json as object};

/// The inspection of a recording.
#[must_use]
pub fn json(recording: &Recording, inspection: &Inspection) -> String {
    let all = object!({
        "format": "ugv-inspection/1",
        "recording": recording.name,
        "fit_for_diagnosis": inspection.fitness.0.name(),
        "because": inspection.fitness.1,
        "doubts": inspection.doubts.iter().map(doubt).collect::<Vec<_>>(),
        "notes": recording.notes.iter().map(note).collect::<Vec<_>>(),
        "motion": motion(inspection.motion),
        "channels": inspection.channels.iter().map(channel).collect::<Vec<_>>(),
        "delays": inspection.delays.iter().map(delay).collect::<Vec<_>>(),
        "runs": inspection.runs.iter().map(|run| object!({
            "run": run.label,
            "start": run.start,
            "motion": motion(run.motion),
            "channels": run.timing.iter().map(|(channel, found)| {
                let mut value = timing(*found);
                value["channel"] = channel.name().into();
                value
            }).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
    });
    // This value always has a text.
    serde_json::to_string_pretty(&all).unwrap_or_default() + "\n"
}

/// A doubt, also in other files.
pub fn doubt(doubt: &Doubt) -> Value {
    object!({
        "kind": doubt.kind.name(),
        "channels": doubt.channels.iter().map(|channel| channel.name()).collect::<Vec<_>>(),
        "where": doubt.span.map(|span| object!({
            "run": span.run,
            "start": span.start,
            "end": span.end,
        })),
        "probability": doubt.probability,
        "left_out": doubt.is_left_out(),
        "evidence": doubt.evidence,
        "remedy": doubt.remedy,
    })
}

fn note(note: &Note) -> Value {
    object!({
        "warning": note.kind.is_warning(),
        "channel": note.channel.map(|channel| channel.name()),
        "count": note.count,
        "line": note.line,
        "text": note.text,
    })
}

fn motion(motion: MotionSummary) -> Value {
    object!({
        "duration": motion.duration,
        "distance": motion.distance,
        "turned": motion.turned,
        "at_rest": motion.at_rest,
    })
}

fn timing(timing: Timing) -> Value {
    object!({
        "samples": timing.samples,
        "median_interval": timing.interval,
        "interval_5_percent": timing.usual.0,
        "interval_95_percent": timing.usual.1,
        "longest_interval": timing.longest,
        "longest_interval_start": timing.longest_at.0,
        "share_in_gaps": timing.in_gaps,
    })
}

fn channel(report: &ChannelReport) -> Value {
    let noise = |noise: Option<Noise>| {
        noise.map(|noise| {
            let mut value = interval(noise.deviation);
            value["count"] = noise.count.into();
            value
        })
    };
    let mut value = timing(report.timing);
    value["channel"] = report.channel.name().into();
    value["unit"] = report.channel.unit().into();
    value["noise_at_rest"] = noise(report.noise_at_rest).into();
    value["noise_in_motion"] = noise(report.noise_in_motion).into();
    value
}

fn interval(interval: IntervalEstimate) -> Value {
    object!({ "value": interval.value, "low": interval.low, "high": interval.high })
}

fn delay(delay: &Delay) -> Value {
    object!({
        "of": delay.pair.of.name(),
        "behind": delay.pair.behind.name(),
        "seconds": interval(delay.seconds),
        "scale": interval(delay.scale),
        "correlation": delay.correlation,
        "quality": quality(delay.quality),
        "signals_contradict": delay.contradicts,
        "blocks": delay.blocks,
    })
}
