use gronwall::{scene::*, setup::*, contact::*, norms::*, vhi::*};
use std::time::Instant;
fn main(){
  let a:Vec<String>=std::env::args().collect();
  let t=Instant::now();
  let s=Setup::new(Scene::read(std::path::Path::new(&a[1])).unwrap_or_else(|e|panic!("{e}"))).unwrap_or_else(|e|panic!("{e}"));
  println!("setup {:.3}s", t.elapsed().as_secs_f64());
  if let Some(e)=&s.exact { let t=Instant::now(); for tt in [0.25,0.5,1.0]{ println!("zeta {tt} {:.14}", e.zeta.at(tt)); } println!("zeta time {:.3}", t.elapsed().as_secs_f64()); }
  for n in a[2].split(',').map(|x|x.parse::<u32>().unwrap()) { let t=Instant::now(); let d=MeshData::new(&s,n,None).unwrap();
   println!("mesh {n} {:.3}", t.elapsed().as_secs_f64());
   for k in a[3].split(',').map(|x|x.parse::<u32>().unwrap()) {
    let t=Instant::now(); let mut m=StepErrors::default(); let mut tm=0.0;
    let info=march(&d.space,&s.model,&s.grid(k),&mut TruthLoad(&*d.truth),&Newton::default(),&mut |v|{ let t0=Instant::now(); let mo=d.truth.moments(v.t)?; let e=step_errors(&d.space,&s.model,v,&mo); m.v=m.v.max(e.v); m.l2=m.l2.max(e.l2); m.stress=m.stress.max(e.stress); m.trace=m.trace.max(e.trace); m.pressure=m.pressure.max(e.pressure); m.contact_set=m.contact_set.max(e.contact_set); tm+=t0.elapsed().as_secs_f64(); Ok(())});
    match info { Ok(i)=>println!("n {n} N {k}: {:?} newton {} kkt {:.1e} load {:.3} moments {:.3} total {:.3}", m, i.newton_iterations, i.kkt_residual, i.seconds_load, tm, t.elapsed().as_secs_f64()), Err(e)=>println!("ERR {e}") }
   } }
}
