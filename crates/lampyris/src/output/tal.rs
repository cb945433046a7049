//! Captures of a relay wall as y-tal loads them: HDF5 with the keys of its `NLOSCaptureData`.

use std::path::Path;

use hdf5_pure::FileBuilder;

use super::atomic::write_whole;
use crate::error::{Error, Result};
use crate::image::luminance;
use crate::transient::{Grid, SPEED_OF_LIGHT, Transient};

/// Whether the extension of `path` names HDF5, in either case.
pub fn is_hdf5(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    ["hdf5", "h5"].contains(&extension.as_str())
}

/// Writes the luminance of a captured wall as HDF5 for y-tal, in metres: `H` of shape (bins, width, height), time first,
/// or (bins, laser's width, laser's height, width, height) where the laser has a grid of its own; with grids of shape (width,
/// height, 3). The file appears whole or not at all.
///
/// # Errors
/// Light without a [`Capture`](crate::transient::Capture), or what the operating system says.
pub fn write_tal(path: &Path, transient: &Transient) -> Result<()> {
    write_whole(path, &encode_tal(transient)?)
}

/// The bytes of such a file.
///
/// # Errors
/// Light without a [`Capture`](crate::transient::Capture).
pub fn encode_tal(transient: &Transient) -> Result<Vec<u8>> {
    // The enumerations of y-tal, which it keeps as numbers.
    const T_SX_SY: i32 = 1;
    const T_LX_LY_SX_SY: i32 = 2;
    const X_Y_3: i32 = 2;
    let capture = transient.capture().ok_or_else(|| {
        Error::new("the file does not tell where the wall was lit and looked at")
            .with_hint("HDF5 needs a \"capture\" in the .json beside the array")
    })?;
    let (width, height, bins) = (transient.width(), transient.height(), transient.bins());
    let metres = SPEED_OF_LIGHT / transient.timing().light_speed;
    let [lasers_wide, lasers_high] = capture.lasers(width, height);
    let (wide, high) = (width / lasers_wide, height / lasers_high);
    let mut light = vec![0.0f32; width * height * bins];
    for x in 0..width {
        for y in 0..height {
            let laser = x / wide * lasers_high + y / high;
            let pixel = (laser * wide + x % wide) * high + y % high;
            for (bin, &value) in transient.profile(x, y).iter().enumerate() {
                light[bin * width * height + pixel] = luminance(value);
            }
        }
    }
    let (shape, format) = match lasers_wide * lasers_high {
        1 => (vec![bins, wide, high], T_SX_SY),
        _ => (vec![bins, lasers_wide, lasers_high, wide, high], T_LX_LY_SX_SY),
    };
    let shape: Vec<u64> = shape.into_iter().map(|length| length as u64).collect();
    let mut file = FileBuilder::new();
    file.create_dataset("H").with_f32_data(&light).with_shape(&shape);
    file.create_dataset("H_format").with_i32_data(&[format]);
    for (name, place) in [("sensor_xyz", capture.sensor_xyz), ("laser_xyz", capture.laser_xyz)] {
        if let Some(place) = place {
            file.create_dataset(name).with_f32_data(&place.map(|number| (number * metres) as f32));
        }
    }
    let grids = [
        ("sensor_grid_xyz", &capture.sensor_grid_xyz, metres),
        ("sensor_grid_normals", &capture.sensor_grid_normals, 1.0),
        ("laser_grid_xyz", &capture.laser_grid_xyz, metres),
        ("laser_grid_normals", &capture.laser_grid_normals, 1.0),
    ];
    for (name, grid, unit) in grids {
        let (numbers, shape) = transposed(grid, unit);
        file.create_dataset(name).with_f32_data(&numbers).with_shape(&shape);
    }
    for name in ["sensor_grid_format", "laser_grid_format"] {
        file.create_dataset(name).with_i32_data(&[X_Y_3]);
    }
    let axis = transient.axis();
    file.create_dataset("delta_t").with_f32_data(&[(axis.bin_width * metres) as f32]);
    file.create_dataset("t_start").with_f32_data(&[(axis.start * metres) as f32]);
    let counts = u8::from(capture.t_accounts_first_and_last_bounces);
    file.create_dataset("t_accounts_first_and_last_bounces").with_u8_data(&[counts]);
    file.finish().map_err(|error| Error::new(format!("the capture cannot be written as HDF5: {error}")))
}

/// Column by column instead of row by row, in another unit, with the shape (columns, rows, 3).
fn transposed(grid: &Grid, unit: f64) -> (Vec<f32>, [u64; 3]) {
    let (width, height) = (grid.first().map_or(0, Vec::len), grid.len());
    let points = (0..width).flat_map(|x| grid.iter().map(move |row| row[x]));
    (points.flatten().map(|number| (number * unit) as f32).collect(), [width as u64, height as u64, 3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transient::{Capture, Timing};

    #[test]
    fn light_and_grids_are_in_metres_with_time_first() {
        let values = (0..24).map(|value| (value / 3) as f32).collect();
        let timing = Timing { light_speed: SPEED_OF_LIGHT * 100.0, ..Timing::new(50.0, 0.5) }; // centimetres
        let grid: Grid = (0..2).map(|y| (0..2).map(|x| [f64::from(x), f64::from(y), 7.0]).collect()).collect();
        let capture = Capture {
            sensor_xyz: None,
            laser_xyz: Some([100.0, 0.0, 0.0]),
            sensor_grid_xyz: grid.clone(),
            sensor_grid_normals: grid,
            laser_grid_xyz: vec![vec![[3.0, 0.0, 0.0]]],
            laser_grid_normals: vec![vec![[0.0, 0.0, 1.0]]],
            t_accounts_first_and_last_bounces: false,
        };
        let transient = Transient::from_values((2, 2, 2), timing, values).expect("24 values");
        assert!(encode_tal(&transient).is_err(), "it has no capture");
        let bytes = encode_tal(&transient.with_capture(capture).expect("it fits")).expect("encodes");
        let file = hdf5_pure::File::from_bytes(bytes).expect("valid");
        let light = file.dataset("H").expect("there");
        assert_eq!(light.shape().expect("a shape"), [2, 2, 2]);
        let light = light.read_f32().expect("numbers");
        // (bin, x, y) of values counted by row, column, bin.
        for (found, expected) in light.iter().zip([0.0, 4.0, 2.0, 6.0, 1.0, 5.0, 3.0, 7.0]) {
            assert!((found - expected).abs() < 1e-5, "{light:?}");
        }
        let numbers = |name: &str| file.dataset(name).expect("there").read_f32().expect("numbers");
        assert_eq!(numbers("sensor_grid_xyz")[3..6], [0.0, 0.01, 0.07]);
        assert_eq!(numbers("sensor_grid_normals")[3..6], [0.0, 1.0, 7.0]);
        assert_eq!(
            (numbers("delta_t"), numbers("t_start"), numbers("laser_xyz")),
            (vec![0.005], vec![0.5], vec![1.0, 0.0, 0.0])
        );
        assert!(file.dataset("sensor_xyz").is_err());
    }

    #[test]
    fn where_the_laser_has_a_grid_its_points_come_before_those_of_the_sensor() {
        // Two points of the laser beside each other, each with its copy of a sensor's grid of 1 × 3.
        let values = (0..18).map(|value| (value / 3) as f32).collect();
        let column = |height: usize| vec![vec![[0.0; 3]]; height];
        let capture = Capture {
            sensor_xyz: None,
            laser_xyz: None,
            sensor_grid_xyz: column(3),
            sensor_grid_normals: column(3),
            laser_grid_xyz: vec![vec![[0.0; 3]; 2]],
            laser_grid_normals: vec![vec![[0.0; 3]; 2]],
            t_accounts_first_and_last_bounces: false,
        };
        let transient = Transient::from_values((2, 3, 1), Timing::new(0.0, 1.0), values).expect("18 values");
        let bytes = encode_tal(&transient.with_capture(capture).expect("it fits")).expect("encodes");
        let file = hdf5_pure::File::from_bytes(bytes).expect("valid");
        let light = file.dataset("H").expect("there");
        assert_eq!(light.shape().expect("a shape"), [1, 2, 1, 1, 3]);
        let light: Vec<f32> = light.read_f32().expect("numbers").iter().map(|value| value.round()).collect();
        assert_eq!(light, [0.0, 2.0, 4.0, 1.0, 3.0, 5.0]);
    }
}
