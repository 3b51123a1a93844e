//! Scenes whose loads a solver assembles itself.

use scene::{Body, Data, LoadForm, Scene, SceneError};

/// The scene with the loads of the strong form, which are functions: cases then have them beside the assembled ones.
///
/// # Errors
/// A scene whose loads are no functions: one without exact solution, or with u in V^h, whose stress jumps from cell to cell.
pub fn by_density(mut scene: Scene) -> Result<Scene, SceneError> {
    let data = scene.as_contact().map(|body| &body.data);
    let interpolated = data.is_some_and(Data::is_interpolated);
    let what =
        "the loads of the scene are no functions: u is in V^h, and its stress jumps between cells";
    let hint = "leave out --loads, or take a scene of an order in h, such as viscoelastic or state-grazing";
    scene.refuse_if(interpolated, "exact.interpolated", what, hint)?;
    if let Body::Contact(body) = &mut scene.body
        && let Data::Exact { form, .. } = &mut body.data
    {
        *form = LoadForm::Strong;
    }
    Ok(scene)
}
