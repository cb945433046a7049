//! What arrives at one pixel: as a table and as a plot.

use std::fmt::Write;

use crate::error::{Error, Result};
use crate::image::Image;
use crate::transient::Transient;

/// The times of the pixel in column `x`, row `y` as comma-separated values: where each bin begins and ends as optical path
/// length in scene units, when it begins and ends in seconds, and its light by channel.
///
/// # Errors
/// If there is no such pixel.
pub fn profile_csv(transient: &Transient, x: usize, y: usize) -> Result<String> {
    check_pixel(transient, x, y)?;
    let (axis, speed) = (transient.axis(), transient.timing().light_speed);
    let mut text = String::from("start_opl,end_opl,start_s,end_s,red,green,blue\n");
    for (bin, [r, g, b]) in transient.profile(x, y).iter().enumerate() {
        let (start, end) = (axis.edge(bin), axis.edge(bin + 1));
        // A string takes all that is written to it.
        let _ = writeln!(text, "{start},{end},{:e},{:e},{r},{g},{b}", start / speed, end / speed);
    }
    Ok(text)
}

/// The first channel of a picture as comma-separated values: column, row, and `name`; pixels without a finite value left out.
pub fn map_csv(name: &str, image: &Image) -> String {
    let mut text = format!("x,y,{name}\n");
    for (index, [value, ..]) in image.pixels().iter().enumerate() {
        if value.is_finite() {
            let _ = writeln!(text, "{},{},{value}", index % image.width(), index / image.width());
        }
    }
    text
}

/// Fails if there is no such pixel.
///
/// # Errors
/// If there is none.
pub fn check_pixel(transient: &Transient, x: usize, y: usize) -> Result<()> {
    let (width, height) = (transient.width(), transient.height());
    match x < width && y < height {
        true => Ok(()),
        false => Err(Error::new(format!("there is no pixel {x},{y}: the picture is {width} × {height}"))
            .with_hint("pixels count from 0,0 at the top left")),
    }
}

/// Width and height of a plot, and the room for its axes: left, right, top, bottom.
const SIZE: [f64; 2] = [720.0, 400.0];
const ROOM: [f64; 4] = [84.0, 20.0, 52.0, 52.0];

/// The times of a pixel as a plot in SVG: a step for each bin; path length below, time above, the light of a bin on the left.
/// Grey light has one black line, coloured light one for each channel.
///
/// # Errors
/// If there is no such pixel.
pub fn profile_svg(transient: &Transient, x: usize, y: usize) -> Result<String> {
    check_pixel(transient, x, y)?;
    let profile = transient.profile(x, y);
    let axis = transient.axis();
    let lengths = Scale { range: [axis.edge(0), axis.edge(profile.len())], place: [ROOM[0], SIZE[0] - ROOM[1]] };
    let finite = profile.iter().flatten().copied().filter(|value| value.is_finite()).map(f64::from);
    let [low, high] = finite.fold([0.0f64, 0.0], |[low, high], value| [low.min(value), high.max(value)]);
    let high = if high > low { high } else { low + 1.0 };
    let values = Scale { range: [low, high], place: [SIZE[1] - ROOM[3], ROOM[2]] };

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        SIZE[0], SIZE[1]
    );
    axes(&mut svg, transient, &lengths, &values);
    let is_grey = profile.iter().all(|[r, g, b]| r == g && g == b);
    let lines: &[(usize, &str)] = if is_grey { &[(0, "black")] } else { &[(0, "#c00"), (1, "#080"), (2, "#00c")] };
    for &(channel, color) in lines {
        let mut path = String::new();
        for (bin, value) in profile.iter().enumerate() {
            let value = if value[channel].is_finite() { value[channel].into() } else { 0.0 };
            let (from, to) = (lengths.at(axis.edge(bin)), lengths.at(axis.edge(bin + 1)));
            let command = if bin == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{command}{from:.2} {0:.2}H{to:.2}", values.at(value));
        }
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.2\"/>");
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// Where the numbers of a range stand.
struct Scale {
    range: [f64; 2],
    place: [f64; 2],
}

impl Scale {
    fn at(&self, value: f64) -> f64 {
        let share = (value - self.range[0]) / (self.range[1] - self.range[0]);
        // Bins too narrow beside their start to be told from it have no width.
        let share = if share.is_finite() { share } else { 0.0 };
        self.place[0] + share * (self.place[1] - self.place[0])
    }

    /// Some five round numbers in the range, with their texts.
    fn ticks(&self) -> Vec<(f64, String)> {
        let span = self.range[1] - self.range[0];
        let rough = span / 5.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
        let Some(step) = step.filter(|step| step.is_normal()) else { return Vec::new() };
        let first = (self.range[0] / step).ceil();
        let count = ((self.range[1] / step).floor() - first).clamp(0.0, 20.0) as usize;
        (0..=count)
            .map(|index| {
                let value = (first + index as f64) * step;
                let decimals = (-step.log10().floor()).max(0.0) as usize;
                let largest = self.range[0].abs().max(self.range[1].abs());
                let text =
                    if largest < 1e5 && step > 1e-5 { format!("{value:.decimals$}") } else { format!("{value:.2e}") };
                (value, text)
            })
            .collect()
    }
}

fn axes(svg: &mut String, transient: &Transient, lengths: &Scale, values: &Scale) {
    let [left, right] = lengths.place;
    let [bottom, top] = values.place;
    let _ = writeln!(
        svg,
        "<path d=\"M{left} {top}V{bottom}H{right}V{top}Z\" fill=\"none\" stroke=\"#888\"/>\n\
         <text x=\"{0}\" y=\"{1}\" text-anchor=\"middle\">optical path length (scene units)</text>\n\
         <text x=\"18\" y=\"{2}\" text-anchor=\"middle\" transform=\"rotate(-90 18 {2})\">radiance within a bin</text>",
        (left + right) / 2.0,
        SIZE[1] - 12.0,
        (top + bottom) / 2.0
    );
    for (value, text) in lengths.ticks() {
        let x = lengths.at(value);
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.2} {bottom}v5\" stroke=\"#888\"/><text x=\"{x:.2}\" y=\"{0}\" text-anchor=\"middle\">{text}</text>",
            bottom + 18.0
        );
    }
    let longest = lengths.range[0].abs().max(lengths.range[1].abs());
    let (unit, per_second) = time_unit(longest / transient.timing().light_speed);
    let to_time = per_second / transient.timing().light_speed;
    let times = Scale { range: lengths.range.map(|length| length * to_time), place: lengths.place };
    let _ = writeln!(svg, "<text x=\"{}\" y=\"16\" text-anchor=\"middle\">time ({unit})</text>", (left + right) / 2.0);
    for (value, text) in times.ticks() {
        let x = times.at(value);
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.2} {top}v-5\" stroke=\"#888\"/><text x=\"{x:.2}\" y=\"{0}\" text-anchor=\"middle\">{text}</text>",
            top - 9.0
        );
    }
    for (value, text) in values.ticks() {
        let y = values.at(value);
        let _ = writeln!(
            svg,
            "<path d=\"M{left} {y:.2}h-5\" stroke=\"#888\"/><text x=\"{0}\" y=\"{1:.2}\" text-anchor=\"end\">{text}</text>",
            left - 8.0,
            y + 4.0
        );
    }
}

/// The unit in which a time is at least 1, and how many of it make a second.
fn time_unit(seconds: f64) -> (&'static str, f64) {
    let units = [("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9)];
    units.into_iter().find(|(_, per_second)| seconds * per_second >= 1.0).unwrap_or(("ps", 1e12))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transient::{SPEED_OF_LIGHT, Timing};

    fn sample() -> Transient {
        let timing = Timing::new(2.0, SPEED_OF_LIGHT * 1e-9);
        Transient::from_values((1, 1, 3), timing, vec![0.0, 0.0, 0.0, 2.5, 1.0, 0.5, 1.0, 1.0, 1.0]).expect("9 values")
    }

    #[test]
    fn a_table_has_a_line_for_each_bin() {
        let transient =
            Transient::from_values((1, 1, 1), Timing::new(2.0, 0.5), vec![2.5, 1.0, 0.5]).expect("3 values");
        let expected = "start_opl,end_opl,start_s,end_s,red,green,blue\n2,2.5,6.671281903963041e-9,8.339102379953801e-9,2.5,1,0.5\n";
        assert_eq!(profile_csv(&transient, 0, 0).expect("a pixel"), expected);
        let error = profile_csv(&transient, 1, 0).expect_err("outside").to_string();
        assert!(error.contains("no pixel 1,0: the picture is 1 × 1"), "{error}");
    }

    #[test]
    fn a_plot_is_well_formed_and_has_a_line_for_each_channel() {
        let svg = profile_svg(&sample(), 0, 0).expect("a pixel");
        let document = roxmltree::Document::parse(&svg).expect("XML");
        let lines = document.descendants().filter(|node| node.attribute("stroke-width").is_some());
        assert_eq!(lines.filter_map(|node| node.attribute("stroke")).collect::<Vec<_>>(), ["#c00", "#080", "#00c"]);
        for text in ["optical path length (scene units)", "time (ns)", "radiance within a bin"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn ticks_are_round_and_lie_in_the_range() {
        let ticks = Scale { range: [0.13, 0.61], place: [0.0, 1.0] }.ticks();
        assert_eq!(
            ticks.iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>(),
            ["0.2", "0.3", "0.4", "0.5", "0.6"]
        );
        assert!(Scale { range: [1.0, 1.0], place: [0.0, 1.0] }.ticks().is_empty());
    }

    #[test]
    fn times_before_0_have_the_unit_that_fits_them() {
        let timing = Timing::new(-SPEED_OF_LIGHT * 3e-9, SPEED_OF_LIGHT * 3e-9);
        let before = Transient::from_values((1, 1, 1), timing, vec![1.0; 3]).expect("3 values");
        assert!(profile_svg(&before, 0, 0).expect("a pixel").contains("time (ns)"));
    }

    #[test]
    fn light_that_is_no_number_draws_a_plot() {
        let values = vec![f32::NAN, f32::INFINITY, -1.0];
        let broken = Transient::from_values((1, 1, 1), Timing::new(-3.0, 1e-30), values).expect("3 values");
        let svg = profile_svg(&broken, 0, 0).expect("a pixel");
        assert!(roxmltree::Document::parse(&svg).is_ok() && !svg.contains("NaN"), "{svg}");
    }

    #[test]
    fn maps_leave_out_what_is_infinite() {
        let image = Image::from_pixels(2, 1, vec![[1.5; 3], [f32::INFINITY; 3]]).expect("two pixels");
        assert_eq!(map_csv("depth", &image), "x,y,depth\n0,0,1.5\n");
    }
}
