use super::*;

/// A hemisphere of a wall whose middle has a radius of 10 mm.
fn dome(thickness_mm: f64, pole_stretch: f64) -> DesignFile {
    let text = format!(
        "name = \"dome\"\n\
         [membrane]\nradial_semi_axis_mm = 10.0\naxial_semi_axis_mm = 10.0\nthickness_mm = {thickness_mm}\n\
         [material]\nlaw = \"neo-hookean\"\nc1_pa = 50000.0\n\
         [rest]\npole_stretch = {pole_stretch}\n"
    );
    DesignFile::parse(&text, "dome").expect("a design")
}

fn own_error(file: &DesignFile) -> OwnError {
    let mut model = Fingertip::new(file).expect("a rest state");
    OwnError::of(&mut model, file, 2e-3, 0.01)
}

/// What a membrane leaves out goes with the wall: a stretched one of a hundredth of the radius hardly bends, an unstretched one of
/// a quarter does little else.
#[test]
fn a_thin_stretched_membrane_is_near_the_solid_and_a_thick_slack_one_far_from_it() {
    let percent = |thickness, stretch| {
        let found = own_error(&dome(thickness, stretch));
        assert!(matches!(found, OwnError::Compared(_)), "{found}");
        found.percent().expect("compared")
    };
    let (thin, thick) = (percent(0.1, 1.3), percent(2.5, 1.02));
    assert!(thin < 3.0, "{thin} %");
    assert!(thick > 50.0, "{thick} %");
}

/// Both models are solved here, each on its own, at one indentation: the solid of the thick wall gives several times the force of
/// the membrane, so what is read at its pressure rise cannot be near.
#[test]
fn the_solid_of_a_thick_wall_gives_several_times_the_force_of_the_membrane() {
    let file = dome(2.5, 1.02);
    let mut membrane = Fingertip::new(&file).expect("a rest state");
    let design = Design {
        rest: RestBy::PoleStretch(1.02),
        ..file.design_to(Axes::Outer)
    };
    assert!((design.membrane.radial_semi_axis - 11.25e-3).abs() < 1e-12);
    let mut solid = Fingertip::of(Kind::Solid(JUDGE), &design).expect("a rest state");
    let [membrane, solid] =
        [&mut membrane, &mut solid].map(|model| model.contact_at(1e-3).expect("a state").force);
    assert!(solid > 2.0 * membrane, "{solid} N for {membrane} N");
}

/// A solid is compared with a finer one, and two elements through the wall are nearer to it than one.
#[test]
fn a_finer_mesh_has_the_smaller_error() {
    let percent = |through: u32, along: u32| {
        let text = format!(
            "name = \"dome\"\n\
             [membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = 1.0\n\
             [material]\nlaw = \"neo-hookean\"\nc1_pa = 50000.0\n\
             [model]\nkind = \"solid\"\nthrough = {through}\nalong = {along}\n"
        );
        own_error(&DesignFile::parse(&text, "dome").expect("a design"))
            .percent()
            .expect("compared")
    };
    let (coarse, fine) = (percent(1, 6), percent(2, 24));
    assert!(coarse > 2.0 * fine, "{coarse} % and {fine} %");
}

/// A lighter touch than those compared can be further off than stated: the statement says from where on it holds.
#[test]
fn the_statement_names_the_lightest_state_compared() {
    let stated = own_error(&dome(0.1, 1.3)).to_string();
    assert!(
        stated.ends_with("of reading at most, from 0.200 mm on"),
        "{stated}"
    );
}
