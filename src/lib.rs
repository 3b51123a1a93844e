pub mod contact;
pub mod history;
pub mod law;
pub mod linalg;
pub mod mesh;
pub mod space;
pub mod tensor;
pub mod vhi;
