//! Integration with fixed steps.

use super::MethodFailure;

/// The classical Runge-Kutta method of order four, with fixed steps.
pub(super) fn runge_kutta<const N: usize>(
    mut rates: impl FnMut(f64, &[f64; N]) -> Option<[f64; N]>,
    [from, to]: [f64; 2],
    steps: usize,
    mut y: [f64; N],
) -> Result<[f64; N], MethodFailure> {
    let step = (to - from) / steps as f64;
    for k in 0..steps {
        let t = from + step * k as f64;
        let blew_up = MethodFailure::BlewUp { position: t };
        let mut along = |by: f64, slope: Option<&[f64; N]>| {
            let mut at = y;
            for (value, rate) in at.iter_mut().zip(slope.into_iter().flatten()) {
                *value += by * rate;
            }
            rates(t + by, &at).ok_or(blew_up)
        };
        let a = along(0.0, None)?;
        let b = along(0.5 * step, Some(&a))?;
        let c = along(0.5 * step, Some(&b))?;
        let d = along(step, Some(&c))?;
        for i in 0..N {
            y[i] += step / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
        }
    }
    Ok(y)
}
