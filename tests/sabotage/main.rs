mod catalogue;
#[path = "../shipped/mod.rs"]
mod shipped;
#[test]
fn t() { assert!(catalogue::all().len() > 40); println!("{}", catalogue::all().len()); }
