//! The object that touches the wall: its action on the outer edges, and its friction from step to step.

use super::{SolidWall, edge};
use crate::object::Friction;
use crate::solid::friction::Sliding;
use crate::solid::object::{Action, Surface};
use crate::solid::state::State;

impl SolidWall {
    /// The object's action on a column's outer edge, if it is near.
    pub(super) fn action(&self, state: &State, column: usize, apex: f64) -> Option<Action> {
        let place = edge(&self.mesh, &state.nodes, column, self.mesh.layers() - 1);
        let stiffening = if self.on_foundation {
            1.0
        } else {
            self.stiffening()
        };
        let (stiffness, near) = (self.contact_stiffness * stiffening, self.mesh.thickness);
        let undeformed = &self.outer[column];
        let mut action = self.surface.action(stiffness, undeformed, &place, apex, near)?;
        if let Some(sliding) = &self.sliding {
            let place = self.over_apex(state, column, apex);
            sliding.add(column, &self.surface, undeformed, &place, &mut action);
        }
        Some(action)
    }

    /// Radii, and heights over an apex, of a column's outer edge.
    fn over_apex(&self, state: &State, column: usize, apex: f64) -> [[f64; 3]; 2] {
        let [r, z] = edge(&self.mesh, &state.nodes, column, self.mesh.layers() - 1);
        [r, z.map(|z| z - apex)]
    }

    /// What a plate answers to penetration, pressure per length, in place of a rigid one's penalty: of objects that are put in its place after this.
    /// `on_foundation`: that is a real foundation's. And the tolerance in place of a dome's, whose wall is far stiffer than a thin disc.
    pub fn resist(&mut self, stiffness: f64, on_foundation: bool, tolerance: f64) {
        self.contact_stiffness = stiffness;
        self.on_foundation = on_foundation;
        self.tolerance = tolerance;
    }

    /// Replaces the plate by an object.
    pub fn touch(&mut self, surface: Surface, friction: Friction) {
        self.surface = surface;
        self.sliding = Sliding::new(friction, self.contact_stiffness, self.mesh.elements.along);
    }

    /// The object that touches the outer surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Whether it has friction: a state then depends on those before it.
    pub fn has_friction(&self) -> bool {
        self.sliding.is_some()
    }

    /// Starts a step from a state in which the points of the outer edges have these anchors. Does nothing without friction.
    pub fn start_sliding(&mut self, state: &State, apex: f64, anchors: &[f64]) {
        let Some(mut sliding) = self.sliding.take() else {
            return;
        };
        for column in 0..self.mesh.elements.along {
            sliding.start(
                column,
                &self.surface,
                &self.over_apex(state, column, apex),
                anchors,
            );
        }
        self.sliding = Some(sliding);
    }

    /// The anchors at the end of a step in a settled state, and the energy lost by sliding in it. Empty without friction.
    pub fn finish_sliding(&self, state: &State, apex: f64) -> (Vec<f64>, f64) {
        let Some(sliding) = &self.sliding else {
            return (Vec::new(), 0.0);
        };
        let (mut anchors, mut dissipated) = (Vec::new(), 0.0);
        for column in 0..self.mesh.elements.along {
            let place = self.over_apex(state, column, apex);
            let (of_edge, by_edge) = sliding.finish(column, &self.surface, &self.outer[column], &place);
            anchors.extend(of_edge);
            dissipated += by_edge;
        }
        (anchors, dissipated)
    }
}
