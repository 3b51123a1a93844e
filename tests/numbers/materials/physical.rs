//! Regions by a condition and by a physical group of the mesh file: the same cells, the same numbers to the bit.

use scene::setup::Setup;

use crate::judged;
use crate::shipped::{edited, on_mesh, setup_of, text};

/// `layered` on the two layers of a mesh file, its region given by `place`.
fn layered(place: &str) -> Setup {
    let domain = "shape = \"mesh\"\nfile = \"../tests/fixtures/layers-2.2.msh\"";
    let on_file = edited(&text("layered"), "shape = \"rectangle\"\nsize = [1.0, 1.0]", domain);
    setup_of(edited(&on_file, "where = \"y - 0.5\"", place))
}

/// `frustum` with a stiffer upper layer; its displacement stays, the loads follow.
fn frustum(place: &str) -> Setup {
    let region = format!(
        "[[material.region]]\nname = \"stiff\"\n{place}\nlambda = 2.0\nmu_L = 1.5\n\n[contact]"
    );
    setup_of(edited(&text("frustum"), "\n[contact]", &format!("\n{region}")))
}

/// Everything recorded of a case but the seconds.
fn record(setup: &Setup, n: u32, steps: u32) -> String {
    let norms = [setup.scene.predicts[0].norm];
    let mut found = judged::record(setup, &on_mesh(setup, n), n, steps, &norms);
    (found.seconds_load, found.seconds_assemble, found.seconds_factor) = (0.0, 0.0, 0.0);
    (found.seconds_solve, found.seconds_total) = (0.0, 0.0);
    assert!(found.errors.iter().all(|error| error.error.is_some_and(f64::is_finite)), "{found:?}");
    format!("{found:?}")
}

#[test]
fn a_condition_and_a_physical_group_give_identical_records() {
    let [by_place, by_name] = ["where = \"y - 0.5\"", "physical = \"upper\""].map(layered);
    for n in [2, 5, 8] {
        assert_eq!(record(&by_place, n, 4), record(&by_name, n, 4), "n = {n}");
    }
    // The other group is another body.
    let other = layered("physical = \"lower\"");
    assert_ne!(record(&by_place, 4, 4), record(&other, 4, 4));
    let above = "where = \"0.8660254037844387*y - 0.5*x - 0.5\"";
    let [by_place, by_name] = [above, "physical = \"upper\""].map(frustum);
    assert_eq!(record(&by_place, 2, 2), record(&by_name, 2, 2));
    assert_ne!(record(&by_place, 2, 2), record(&frustum("physical = \"lower\""), 2, 2));
}

/// The manufactured side finds regions by the coarse simplices, the solver by the numbers of its cells.
#[test]
fn both_sides_see_one_region() {
    for setup in [layered("physical = \"upper\""), frustum("physical = \"upper\"")] {
        let exact = setup.exact.as_ref().expect("exact");
        let space = setup.space(3).unwrap_or_else(|error| panic!("{error}"));
        let seen = exact.cell_regions(&space.mesh);
        assert!(seen.contains(&0) && seen.contains(&1));
        assert!(
            space.regions.iter().zip(&seen).all(|(region, seen)| usize::from(*region) == *seen)
        );
        // Facets of the boundary lie on the simplices, not in them.
        let (mesh, d) = (&space.mesh, space.mesh.dimension);
        let sides = [mesh.side("top").expect("top")];
        let top = mesh.facets_on(&sides);
        let middles: Vec<[f64; 3]> =
            top.map(|f| mesh.point(mesh.facet(f), &vec![1.0 / d as f64; d])).collect();
        assert!(exact.regions_at(&middles).iter().all(|region| *region == 1));
    }
}

#[test]
fn two_regions_on_one_group_are_refused() {
    let second = "physical = \"upper\"\nE = 1.0\nnu = 0.3\n[[material.region]]\nname = \"twice\"\nphysical = \"upper\"";
    let Err(error) = layered(second).space(2) else { panic!("accepted") };
    assert!(error.to_string().contains("in the regions `stiff` and `twice`"), "{error}");
}
