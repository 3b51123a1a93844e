//! Tables of a study as CSV.

/// Rows of named cells as CSV, below the names of the cells.
///
/// # Errors
/// The writer's.
pub(crate) fn csv<const N: usize>(
    rows: impl IntoIterator<Item = [(&'static str, String); N]>,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (i, row) in rows.into_iter().enumerate() {
        if i == 0 {
            writer.write_record(row.each_ref().map(|(name, _)| *name))?;
        }
        writer.write_record(row.each_ref().map(|(_, cell)| cell))?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}
