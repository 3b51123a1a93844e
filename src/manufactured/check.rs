pub struct Finding; pub struct Report; pub fn check(){}
