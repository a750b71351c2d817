//! The zone of contact with a frictionless sphere, and its edge.

use super::{LocalEquations, Meridian, Response};
use crate::material::Hyperelastic;
use crate::solver::collocation::GaussPoint;
use core::f64::consts::PI;

impl<L: Hyperelastic> LocalEquations<L> {
    /// Cosine of the tangent's angle at a deformed radius on what touches. `None` beyond its widest.
    #[inline]
    pub(super) fn contact_cosine(&self, radius: f64) -> Option<f64> {
        let sine = self.curvature * radius;
        let squared = 1.0 - sine * sine;
        (squared > 0.0).then(|| libm::sqrt(squared))
    }

    /// What both zones having one tangent at the contact's edge asks for, over `P rho_F`, with derivatives by `u`, `w`, the
    /// pressure, the force's radius and the contact parameter. `None` beyond the object's widest.
    pub fn contact_edge(
        &self,
        edge: &Meridian,
        [u, w]: [f64; 2],
        pressure: f64,
        force_radius: f64,
    ) -> Option<(f64, [f64; 5])> {
        let Meridian { x, x_rate, .. } = *edge;
        let rho = x * u;
        if self.curvature == 0.0 {
            return Some((rho - force_radius, [x, 0.0, 0.0, -1.0, x_rate * u]));
        }
        let cos = self.contact_cosine(rho)?;
        let c = self.curvature;
        let disc = 0.5 * (rho * rho - force_radius * force_radius);
        let pull = c * rho * w / cos;
        let by_rho = pressure * rho + c * x * w / (cos * cos * cos);
        let scale = 1.0 / (pressure * force_radius);
        let by = [
            by_rho * x,
            c * x * rho / cos,
            disc,
            -pressure * force_radius,
            by_rho * u * x_rate + pull * x_rate,
        ];
        Some((scale * (pressure * disc + x * pull), by.map(|part| scale * part)))
    }

    /// [`LocalEquations::point`] in contact with a sphere.
    pub(super) fn on_sphere(
        &self,
        meridian: &Meridian,
        [u, w]: [f64; 2],
        guess: f64,
    ) -> Option<(GaussPoint, Response)> {
        let Meridian {
            x,
            x_rate,
            arc_rate: g,
        } = *meridian;
        let g_t = (self.aspect * self.aspect - 1.0) * x * x_rate / g;
        let over_x = 1.0 / x;
        let c = self.curvature;
        let rho = u * x;
        let cos = self.contact_cosine(rho)?;
        let over_cos = 1.0 / cos;
        let cos_by_rho = -c * c * rho * over_cos;
        let r = self.respond(w * over_cos, u, guess)?;
        // By u, w and the position.
        let radius = [x, 0.0, u * x_rate];
        let cosine = radius.map(|by| cos_by_rho * by);
        let n: [f64; 3] =
            core::array::from_fn(|i| (f64::from(u8::from(i == 1)) - w * over_cos * cosine[i]) * over_cos);
        let l1: [f64; 3] = core::array::from_fn(|i| r.l1_by_n * n[i] + if i == 0 { r.l1_by_u } else { 0.0 });
        let w2: [f64; 3] =
            core::array::from_fn(|i| r.w2_by_l1 * l1[i] + if i == 0 { r.w2_by_u } else { 0.0 });
        let forward = r.l1 * cos;
        // c^2 rho l1 x n, and its relative derivatives summed.
        let turn = c * c * x * rho * w * r.l1 * over_cos;
        let hoop = cos * cos * r.w2 - turn;
        let descent = -g * c * rho * r.l1;
        let area = PI * rho * rho;
        let mut by = [[0.0; 4]; 3];
        for (i, by) in by.iter_mut().enumerate() {
            let forward_by = l1[i] * cos + r.l1 * cosine[i];
            let turn_by = c
                * c
                * over_cos
                * (x * radius[i] * w * r.l1
                    + x * rho * w * (l1[i] - r.l1 * over_cos * cosine[i])
                    + match i {
                        1 => x * rho * r.l1,
                        2 => x_rate * rho * w * r.l1,
                        _ => 0.0,
                    });
            let hoop_by = 2.0 * cos * cosine[i] * r.w2 + cos * cos * w2[i] - turn_by;
            let g_by = if i == 2 { g_t } else { 0.0 };
            let descent_by = -c * (g * (radius[i] * r.l1 + rho * l1[i]) + g_by * rho * r.l1);
            *by = [
                g * forward_by + g_by * forward,
                g * hoop_by + g_by * hoop,
                descent_by,
                area * descent_by + 2.0 * PI * rho * radius[i] * descent,
            ];
        }
        let rate = [
            (g * forward - x_rate * u) * over_x,
            (g * hoop - x_rate * w) * over_x,
        ];
        let point = GaussPoint {
            rate,
            rate_by_state: [
                [(by[0][0] - x_rate) * over_x, by[1][0] * over_x],
                [by[0][1] * over_x, (by[1][1] - x_rate) * over_x],
            ],
            rate_by_position: [
                (by[2][0] + x * u - rate[0] * x_rate) * over_x,
                (by[2][1] + x * w - rate[1] * x_rate) * over_x,
            ],
            integrand: [descent, area * descent],
            integrand_by_state: [[by[0][2], by[1][2]], [by[0][3], by[1][3]]],
            integrand_by_position: [by[2][2], by[2][3]],
            ..GaussPoint::default()
        };
        Some((point, r))
    }
}
