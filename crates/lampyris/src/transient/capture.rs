//! Where a wall was lit and looked at: what seeing around a corner needs to know beside the light.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Points of a grid, row by row, in scene units or as unit vectors.
pub type Grid = Vec<Vec<[f64; 3]>>;

/// The geometry of a capture of a relay wall, under the names of y-tal. The pixels of the light are the points of the wall
/// that the sensor looks at; where the laser has a grid of its own, the picture has as many copies of the sensor's beside and
/// above each other as that has points.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Capture {
    /// Where the sensor stands, in scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor_xyz: Option<[f64; 3]>,
    /// Where the laser stands, in scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laser_xyz: Option<[f64; 3]>,
    /// The point of the wall that each pixel sees: as many rows and columns as the picture, or as one of its copies.
    pub sensor_grid_xyz: Grid,
    /// The wall's normals there.
    pub sensor_grid_normals: Grid,
    /// The points that the laser lights: one; or one for each pixel if the two go together (confocal); or one for each copy
    /// of the sensor's grid (exhaustive).
    pub laser_grid_xyz: Grid,
    /// The wall's normals there.
    pub laser_grid_normals: Grid,
    /// Whether path lengths hold the way from the laser to the wall and that from the wall to the sensor.
    pub t_accounts_first_and_last_bounces: bool,
}

impl Capture {
    /// How many copies of the sensor's grid a picture of this size has beside each other, and how many above each other:
    /// columns and rows of the laser's grid where each of its points lit every point of the sensor's, else one.
    pub fn lasers(&self, width: usize, height: usize) -> [usize; 2] {
        let size = |grid: &Grid| [grid.first().map_or(0, Vec::len), grid.len()];
        let ([lasers_wide, lasers_high], [wide, high]) = (size(&self.laser_grid_xyz), size(&self.sensor_grid_xyz));
        let is_exhaustive =
            lasers_wide.checked_mul(wide) == Some(width) && lasers_high.checked_mul(high) == Some(height);
        if is_exhaustive && width * height > 0 { [lasers_wide, lasers_high] } else { [1, 1] }
    }

    /// Finds what does not fit a picture of this size.
    ///
    /// # Errors
    /// Grids of other sizes, coordinates that are not finite, and first and last ways that count between places that are
    /// not given.
    pub fn check(&self, width: usize, height: usize) -> Result<()> {
        let is =
            |grid: &Grid, width, height| grid.len() == height && grid.iter().all(|row: &Vec<_>| row.len() == width);
        let [columns, rows] = self.lasers(width, height);
        let (lasers_wide, lasers_high) = (self.laser_grid_xyz.first().map_or(0, Vec::len), self.laser_grid_xyz.len());
        let (width, height) = (width / columns, height / rows);
        let sensors = [("sensor_grid_xyz", &self.sensor_grid_xyz), ("sensor_grid_normals", &self.sensor_grid_normals)];
        let lasers = [("laser_grid_xyz", &self.laser_grid_xyz), ("laser_grid_normals", &self.laser_grid_normals)];
        if let Some((key, _)) = sensors.iter().find(|(_, grid)| !is(grid, width, height)) {
            return Err(Error::at_key(
                *key,
                format!("the grid must have {height} rows of {width} points, as the picture"),
            ));
        }
        let single = is(&self.laser_grid_xyz, 1, 1);
        let size = match (single, columns * rows > 1) {
            (true, _) => (1, 1),
            (_, true) => (lasers_wide, lasers_high),
            _ => (width, height),
        };
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
