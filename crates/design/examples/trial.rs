//! Trial.
use std::ops::ControlFlow;
fn main() {
    let layout =
        magsplice_layout::Layout::read(std::env::args().nth(1).unwrap().as_ref()).unwrap_or_else(|e| panic!("{e}"));
    let setting = magsplice_design::Setting::of(&layout).unwrap_or_else(|e| panic!("{e}"));
    println!("{} orbits, {} free", setting.orbits(), setting.free());
    let now = std::time::Instant::now();
    let last = std::sync::Mutex::new(0.0);
    let outcome = setting
        .search(&|p| {
            let mut last = last.lock().unwrap();
            if now.elapsed().as_secs_f64() > *last + 0.5 {
                *last = now.elapsed().as_secs_f64();
                println!("{:.1} s {p:?}", *last);
            }
            ControlFlow::Continue(())
        })
        .unwrap_or_else(|e| panic!("{e}"));
    println!("{:?}", now.elapsed());
    println!("before {:?}\nafter {:?}\nfiner {:?}", outcome.before, outcome.after, outcome.finer);
    for s in &outcome.stages {
        println!("{s:?}");
    }
    println!("{} parts, {} agreeing, {:?}", outcome.parts, outcome.agreeing_starts, outcome.short_of);
    for t in &outcome.tiles {
        let p = t.position();
        if p.x >= 0.0 && p.y >= 0.0 && p.x >= p.y {
            println!("{:?} {:?} {:?}", t.position(), t.size(), t.polarization_t());
        }
    }
}
