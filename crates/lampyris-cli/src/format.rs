//! Numbers and times, short enough to be read at a glance.

use std::time::Duration;

use lampyris::film::Bias;

/// `950`, `12.3k`, `4.56M`, `7.89G`.
pub fn count(value: f64) -> String {
    let (scaled, unit) = match value {
        _ if value >= 1e9 => (value / 1e9, "G"),
        _ if value >= 1e6 => (value / 1e6, "M"),
        _ if value >= 1e3 => (value / 1e3, "k"),
        _ => return format!("{value:.0}"),
    };
    // Three figures that count.
    let decimals = if scaled >= 100.0 { 0 } else { 1 + usize::from(scaled < 10.0) };
    format!("{scaled:.decimals$}{unit}")
}

/// `0.35 s`, `12.3 s`, `4:05`, `2:00:07`.
pub fn time(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    if seconds < 9.995 {
        return format!("{seconds:.2} s");
    }
    if seconds < 59.95 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, minutes, seconds) => format!("{minutes}:{seconds:02}"),
        (hours, minutes, seconds) => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

/// `950 bytes`, `12.3 MiB`, `1.20 GiB`.
pub fn bytes(value: f64) -> String {
    let units = ["KiB", "MiB", "GiB", "TiB"];
    let power = ((value.max(1.0).log2() / 10.0) as usize).min(units.len());
    if power == 0 {
        return format!("{value:.0} bytes");
    }
    let scaled = value / 1024f64.powi(power as i32);
    // Three figures that count.
    let decimals = if scaled >= 99.95 { 0 } else { 1 + usize::from(scaled < 9.995) };
    format!("{scaled:.decimals$} {}", units[power - 1])
}

/// `2.1 %`, with two figures that count.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = if percent >= 9.95 { 0 } else { 1 + usize::from(percent < 0.995) };
    format!("{percent:.decimals$} %")
}

/// Student's t of seven degrees of freedom, as eight groups of passes tell the error of a bias: 95 % of all lie within.
const SURE: f64 = 2.4;

/// The largest that a bias may be, at 95 %.
pub fn most(bias: &Bias) -> f64 {
    bias.at_most(SURE)
}

/// `bias about 0.30 % ± 0.05 %`, or `bias below 0.2 %` where it cannot be told from none.
pub fn bias(bias: &Bias) -> String {
    match bias.square > SURE * bias.error_of_square {
        true => format!("bias about {} ± {}", percent(bias.rms()), percent(bias.standard_error())),
        false => format!("bias below {}", percent(most(bias))),
    }
}

/// `1 shape`, `2 shapes`; `1 pass`, `2 passes`.
pub fn plural(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ if what.ends_with('s') => format!("{count} {what}es"),
        _ => format!("{count} {what}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_three_figures() {
        let values = [0.0, 950.0, 12_345.0, 4_560_000.0, 123_456_789.0, 7.89e9];
        assert_eq!(values.map(count), ["0", "950", "12.3k", "4.56M", "123M", "7.89G"]);
    }

    #[test]
    fn times_are_seconds_then_clocks() {
        let times = [0.351, 12.34, 59.97, 245.0, 7207.4].map(|seconds| time(Duration::from_secs_f64(seconds)));
        assert_eq!(times, ["0.35 s", "12.3 s", "1:00", "4:05", "2:00:07"]);
    }

    #[test]
    fn plurals_are_english() {
        assert_eq!([plural(1, "pass"), plural(2, "pass"), plural(0, "shape")], ["1 pass", "2 passes", "0 shapes"]);
    }

    #[test]
    fn bytes_have_the_unit_that_fits() {
        let values = [950.0, 12.3 * 1024.0, 1.5 * 1024f64.powi(3), 2048.0 * 1024f64.powi(3)];
        assert_eq!(values.map(bytes), ["950 bytes", "12.3 KiB", "1.50 GiB", "2.00 TiB"]);
    }

    #[test]
    fn shares_are_percents() {
        assert_eq!([0.25, 0.021, 0.00512].map(percent), ["25 %", "2.1 %", "0.51 %"]);
    }

    #[test]
    fn a_bias_is_told_if_it_is_one() {
        let told = |square, error_of_square| bias(&Bias { square, error_of_square });
        assert_eq!(told(9e-6, 6e-7), "bias about 0.30 % ± 0.01 %");
        assert_eq!(told(9e-6, 5e-6), "bias below 0.46 %");
        assert_eq!(told(-9e-6, 1e-6 / 2.4), "bias below 0.10 %");
    }
}
