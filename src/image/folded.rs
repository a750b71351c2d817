//! A design of the build script's words, folded into the code.

/// Implements a [`Design`](crate::signal::design::Design) of no bytes by the tables of a module: of an elastic wall, or of a relaxing
/// one, whose series stands beside them; with more items of it.
macro_rules! folded_design {
    ($name:ident, $($module:ident)::+, elastic, $parameters:expr, { $($more:tt)* }) => {
        folded_design!(
            $name,
            $($module)::+,
            $parameters,
            crate::signal::wall::Elastic,
            None,
            { $($more)* }
        );
    };
    ($name:ident, $($module:ident)::+, relaxing, $parameters:expr, { $($more:tt)* }) => {
        folded_design!(
            $name,
            $($module)::+,
            $parameters,
            crate::signal::wall::Memory<{ $($module)::+::RELAXATION.step.count }>,
            Some(&$($module)::+::RELAXATION),
            { $($more)* }
        );
    };
    ($name:ident, $($module:ident)::+, $parameters:expr, $wall:ty, $series:expr, { $($more:tt)* }) => {
        /// A design of the image, against its plate: no bytes, as all of it folds into the code.
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl $name {
            /// What the signal path needs of it.
            pub const PARAMETERS: crate::signal::design::Parameters = $parameters;
        }

        impl crate::signal::design::Design for $name {
            type Wall = $wall;
            type Around = [crate::signal::zero::surroundings::Surroundings; Self::PARAMETERS.rates.places()];

            #[inline]
            fn series(&self) -> Option<&model_tables::material::series::WallSeries> {
                const { $series }
            }

            #[inline]
            fn parameters(&self) -> &crate::signal::design::Parameters {
                const { &Self::PARAMETERS }
            }

            #[inline]
            fn limits(&self) -> crate::signal::zero::limits::Limits {
                const { Self::PARAMETERS.limits }
            }

            #[inline]
            fn lookup(&self, rise: model_tables::units::PressureRise) -> model_tables::table::Reading {
                $($module)::+::TABLES.lookup(rise.0).into()
            }

            $($more)*
        }
    };
}
