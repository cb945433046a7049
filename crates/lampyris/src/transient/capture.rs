//! Where a wall was lit and looked at: what seeing around a corner needs to know beside the light.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Points of a grid, row by row, in scene units or as unit vectors.
pub type Grid = Vec<Vec<[f64; 3]>>;

/// The geometry of a capture of a relay wall, under the names of y-tal. The pixels of the light are the points of the wall
/// that the sensor looks at.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Capture {
    /// Where the sensor stands, in scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor_xyz: Option<[f64; 3]>,
    /// Where the laser stands, in scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laser_xyz: Option<[f64; 3]>,
    /// The point of the wall that each pixel sees: as many rows and columns as the picture.
    pub sensor_grid_xyz: Grid,
    /// The wall's normals there.
    pub sensor_grid_normals: Grid,
    /// The points that the laser lights: one, or one for each pixel if the two go together (confocal).
    pub laser_grid_xyz: Grid,
    /// The wall's normals there.
    pub laser_grid_normals: Grid,
    /// Whether path lengths hold the way from the laser to the wall and that from the wall to the sensor.
    pub t_accounts_first_and_last_bounces: bool,
}

impl Capture {
    /// Finds what does not fit a picture of this size.
    ///
    /// # Errors
    /// Grids of other sizes, coordinates that are not finite, and first and last ways that count between places that are
    /// not given.
    pub fn check(&self, width: usize, height: usize) -> Result<()> {
        let is =
            |grid: &Grid, width, height| grid.len() == height && grid.iter().all(|row: &Vec<_>| row.len() == width);
        let sensors = [("sensor_grid_xyz", &self.sensor_grid_xyz), ("sensor_grid_normals", &self.sensor_grid_normals)];
        let lasers = [("laser_grid_xyz", &self.laser_grid_xyz), ("laser_grid_normals", &self.laser_grid_normals)];
        if let Some((key, _)) = sensors.iter().find(|(_, grid)| !is(grid, width, height)) {
            return Err(Error::at_key(
                *key,
                format!("the grid must have {height} rows of {width} points, as the picture"),
            ));
        }
        let single = is(&self.laser_grid_xyz, 1, 1);
        let size = if single { (1, 1) } else { (width, height) };
        if let Some((key, _)) = lasers.iter().find(|(_, grid)| !is(grid, size.0, size.1)) {
            let message = format!("the grid must have one point, or {height} rows of {width}, as the picture");
            return Err(Error::at_key(*key, message));
        }
        let finite = |grid: &Grid| grid.iter().flatten().flatten().all(|number| number.is_finite());
        if let Some((key, _)) = sensors.iter().chain(&lasers).find(|(_, grid)| !finite(grid)) {
            return Err(Error::at_key(*key, "coordinates must be finite"));
        }
        let places = [("sensor_xyz", self.sensor_xyz), ("laser_xyz", self.laser_xyz)];
        match places.into_iter().find(|(_, place)| place.is_none()) {
            Some((key, _)) if self.t_accounts_first_and_last_bounces => {
                Err(Error::at_key(key, "must be given where the first and the last way count"))
            }
            _ => Ok(()),
        }
    }
}
