//! Tests of the public interface: fits of scans, and faulty tiles.

mod damage;
mod diagnosis;
mod fit;
mod noisy;
mod sample_scan;
mod sensor_faults;
mod suspect;
mod turn;
mod wild;
