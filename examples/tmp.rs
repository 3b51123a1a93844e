use gronwall::contact::*; use gronwall::history::*; use gronwall::law::*; use gronwall::mesh::*; use gronwall::vhi::*;
use std::sync::Arc; use std::time::Instant;
struct K; impl YieldLimit for K { fn value(&self,z:f64)->f64{0.10+0.05*z} fn slope(&self,_:f64)->f64{0.05} }
struct L{b:Vec<Vec<f64>>}
fn fac(t:f64,o:&mut [f64]){o[0]=t;}
impl Load for L { fn assemble(&mut self,t:f64,o:&mut [f64])->Result<(),LoadError>{ for (a,b) in o.iter_mut().zip(&self.b[0]) {*a=t*b;} Ok(()) }
 fn separated(&self)->Option<Separated<'_>>{ Some(Separated{basis:&self.b, factors:&fac}) } }
fn run<P:Projection>(name:&str, p:P, boundary:bool, n:u32, steps:u32) {
 let t0=Instant::now();
 let mesh=rectangle([1.0,1.0],n,Family::Structured); let (top,bot)=(mesh.side("top").unwrap(),mesh.side("bottom").unwrap());
 let s=Discretization::new(mesh,&[top],&[bot]).unwrap();
 let b = boundary.then(|| Boundary{ potential:Arc::new(PiecewiseLinear::new(vec![(0.0,0.0),(0.04,0.08),(0.10,0.05)],0.0,0.0).unwrap()), gap:Box::new(|_|0.10), shift:Box::new(|_|0.0), rule:BoundaryRule::Vertex});
 let m=Model{elasticity:Isotropic{lambda:1.0,mu:1.0},memory:Some(MemoryTerm{kernel:Box::new(ExponentialSum{terms:vec![(-1.0,1.0)]}),tensor:Isotropic{lambda:0.25,mu:0.25}}),projection:p,boundary:b,time_rule:Box::new(Trapezoid)};
 let rule=gronwall::space::quadrature::triangle_degree_4();
 let mut f=vec![0.0;s.dofs()];
 for c in 0..s.mesh.cell_count(){ for (q,w) in rule.points.iter().zip(&rule.weights){ let x=s.mesh.point(s.mesh.cell(c),q); for (a,&node) in s.cell_nodes(c).iter().enumerate(){ if (node as usize)<s.nodes.free { f[2*node as usize+1]+= w*s.geometry.measure[c]*q[a]*(-3.0*x[0]); } } } }
 let mut l=L{b:vec![f]};
 let grid=TimeGrid::uniform(1.0,steps);
 let t1=Instant::now();
 let mut last=(0.0,0.0,vec![]);
 let info=march(&s,&m,&grid,&mut l,&Newton::default(),&mut |v|{ if v.n as u32==steps { let un=(0..s.trace.points.len()).map(|i|s.trace.normal(i,v.u)).collect(); last=(v.strain_norm,v.zeta,un);} });
 let t2=Instant::now();
 match info { Ok(i)=>println!("{name} {n} {steps}: setup {:.3} march {:.3} norm {:.15} zeta {:.15} newton {} changes {} kkt {:.2e} {:?}\n {:?}",(t1-t0).as_secs_f64(),(t2-t1).as_secs_f64(),last.0,last.1,i.newton_iterations,i.active_set_changes,i.kkt_residual,i.work, last.2.iter().step_by((last.2.len()/2).max(1)).collect::<Vec<_>>()), Err(e)=>println!("{name} {n} {steps} ERR {e}") }
}
fn main(){
 for n in [4,8,64,128]{ run("punch",VonMises{mu:1.0,limit:K},true,n,n); run("elastic",NoProjection,true,n,n); run("linear",NoProjection,false,n,n);} run("linear",NoProjection,false,256,64);
}
