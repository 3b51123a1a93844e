//! Tables of a study as CSV.

/// Rows of named cells as CSV: the names of the first row are the head.
///
/// # Errors
/// The writer's.
pub(crate) fn csv<const N: usize>(
    rows: impl Iterator<Item = [(&'static str, String); N]>,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (i, row) in rows.enumerate() {
        if i == 0 {
            writer.write_record(row.each_ref().map(|(name, _)| *name))?;
        }
        writer.write_record(row.each_ref().map(|(_, cell)| cell))?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}
