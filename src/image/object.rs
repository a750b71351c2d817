//! The design of an image with `[object]`: tables of the touched object, blended when the object changes.

/// Implements a [`Design`](crate::signal::design::Design) by the tables of a module, its ball's and its law, over the design of its plate.
macro_rules! object_design {
    ($name:ident, $plate:ident, $($module:ident)::+) => {
        /// A design with the tables of what is touched in memory.
        #[derive(Clone, Debug)]
        pub struct $name {
            /// Last input covered, counts.
            maximum: i32,
            segments: [[i32; $($module)::+::TABLES.layout.words()]; $($module)::+::TABLES.segments.len()],
            read: Option<model_tables::table::known::ReadPair>,
            /// Whether what is touched is what the design says.
            #[cfg(band)]
            as_designed: bool,
        }

        impl $name {
            /// What the signal path needs of it.
            pub const PARAMETERS: crate::signal::design::Parameters = $plate::PARAMETERS;

            /// Touching what the design says.
            pub fn start() -> Self {
                use crate::signal::design::Design as _;
                let mut design = Self {
                    maximum: $($module)::+::TABLES.layout.maximum,
                    segments: $($module)::+::TABLES.segments,
                    read: None,
                    #[cfg(band)]
                    as_designed: true,
                };
                // The generator saw to it that the law allows it.
                let _ = design.touch($($module)::+::START);
                design
            }

            fn weigh(&mut self, weights: &model_tables::table::law::Weights) {
                use $($module)::+::{BALL, TABLES};
                model_tables::table::blend::blend(
                    &TABLES.layout,
                    TABLES.segments.as_flattened(),
                    BALL.as_flattened(),
                    weights,
                    self.segments.as_flattened_mut(),
                );
                self.maximum = model_tables::table::blend::last_answered(
                    &TABLES.layout,
                    weights,
                    |rise| TABLES.lookup(rise.0).into(),
                    |rise| TABLES.layout.lookup_in(&self.segments, rise.0).into(),
                );
            }
        }

        impl crate::signal::design::Design for $name {
            type Wall = <$plate as crate::signal::design::Design>::Wall;
            type Around = <$plate as crate::signal::design::Design>::Around;

            #[inline]
            fn series(&self) -> Option<&model_tables::material::series::WallSeries> {
                $plate.series()
            }

            #[inline]
            fn limits(&self) -> crate::signal::zero::limits::Limits {
                $plate.limits()
            }

            #[inline]
            fn parameters(&self) -> &crate::signal::design::Parameters {
                const { &$plate::PARAMETERS }
            }

            #[inline]
            fn lookup(&self, rise: model_tables::units::PressureRise) -> model_tables::table::Reading {
                let held = rise.0.min(self.maximum);
                let outputs = $($module)::+::TABLES.layout.lookup_in(&self.segments, held);
                model_tables::table::Reading {
                    saturated: rise.0 > self.maximum,
                    ..outputs.into()
                }
            }

            #[inline]
            fn last_rise(&self) -> model_tables::units::PressureRise {
                model_tables::units::PressureRise(self.maximum)
            }

            #[inline(never)]
            fn touch(
                &mut self,
                touched: model_tables::table::law::Touched,
            ) -> Result<(), crate::signal::design::NoSuchObject> {
                let weights = $($module)::+::LAW
                    .weights(touched)
                    .ok_or(crate::signal::design::NoSuchObject)?;
                self.weigh(&weights);
                self.read = None;
                #[cfg(band)]
                {
                    self.as_designed = touched == $($module)::+::START;
                }
                Ok(())
            }

            #[cfg(band)]
            fn band(&self) -> Option<&model_tables::table::band::ChipBand> {
                const { &$($module)::+::BAND }.as_ref().filter(|_| self.as_designed)
            }

            #[inline]
            fn note(&mut self, read: Option<model_tables::table::known::ReadPair>) {
                self.read = read;
            }

            #[inline(never)]
            fn tell(
                &self,
                known: model_tables::units::Nanometres,
            ) -> Option<model_tables::table::known::KnownContact> {
                use $($module)::+::{BALL, LAW, TABLES};
                let lookups = model_tables::table::known::Lookups {
                    touched: |rise| self.lookup(rise),
                    last: [
                        self.last_rise(),
                        model_tables::units::PressureRise(TABLES.layout.maximum),
                    ],
                    plate: |rise: model_tables::units::PressureRise| model_tables::table::Reading::from(TABLES.lookup(rise.0)),
                    ball: |rise: model_tables::units::PressureRise| model_tables::table::Reading::from(TABLES.layout.lookup_in(&BALL, rise.0)),
                };
                Some(lookups.tell(&LAW, self.read.as_ref()?, known))
            }
        }
    };
}
