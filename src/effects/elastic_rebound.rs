//! Soil that springs back behind the axle.

use super::declaration::effect;

effect! {
    /// The paper's contact ends below the axle; soil that springs back carries load behind it.
    ///
    /// The contact reaches from -theta_2 to theta_1, and the greatest stress moves with its
    /// middle. At a share of 1 the normal stress is symmetric about the axle, and its horizontal
    /// parts cancel: no compaction drag.
    ElasticRebound: "elastic_rebound", Wheels,
    phrase "soil that springs back behind the wheel",
    lifts "theta_2 = 0",
    equation "theta_2 = share theta_1; sigma over -theta_2..theta_1 with (3) and (4), whose theta_2 is -theta_2 here, about theta_m = (theta_1 - theta_2)/2, with stress_peak about theta_m = (a0 + a1 abs(i)) (theta_1 + theta_2) - theta_2, 0 at least",
    source "Wong, Theory of Ground Vehicles, ch. 2 (exit angle); the stress behind theta_m as in Wong & Reece, J. Terramechanics 4 (1967)",
    check "Compare the depth of the rut under a standing wheel with the depth behind it: the difference is what springs back.",
    formulas differ,
    {
        share ["1"] 0.0..1.0, off 0.0, normal(0.2, 0.15), "Exit angle behind the lowest point as a share of the entry angle";
    }
}
