//! What a knob or a constant is varied over: a range, a list, or one value.

/// The most values of one range.
const MOST: i128 = 1_000_000;

/// A decimal number as it is written: `digits` ÷ 10^`places`. Ranges are counted in these, since 0.1 is no binary
/// fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Decimal {
    digits: i128,
    places: u32,
}

impl Decimal {
    fn parse(text: &str) -> Option<Self> {
        let (sign, plain) = match text.strip_prefix('-') {
            Some(rest) => (-1, rest),
            None => (1, text.strip_prefix('+').unwrap_or(text)),
        };
        let (whole, part) = plain.split_once('.').unwrap_or((plain, ""));
        let all = format!("{whole}{part}");
        // More digits than numbers of 64 bits have mean nothing.
        let is_number = !all.is_empty() && all.len() <= 18 && all.bytes().all(|byte| byte.is_ascii_digit());
        let digits: i128 = all.parse().ok().filter(|_| is_number)?;
        Some(Self { digits: sign * digits, places: part.len() as u32 })
    }

    /// Its digits with as many places, which are no fewer than its own.
    fn scaled(self, places: u32) -> i128 {
        self.digits * 10_i128.pow(places - self.places)
    }

    fn text(self) -> String {
        let places = self.places as usize;
        let digits = format!("{:0width$}", self.digits.abs(), width = places + 1);
        let (whole, part) = digits.split_at(digits.len() - places);
        let sign = if self.digits < 0 { "-" } else { "" };
        if places == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{part}") }
    }
}

/// The values that a text stands for: `0.5:0.9:0.1` is 0.5, 0.6, 0.7, 0.8, 0.9 (from, to, step; with as many places
/// as they are written with), `pipe,taper` those two, anything else itself.
///
/// # Errors
/// What is wrong with a range.
pub fn values(text: &str) -> Result<Vec<String>, String> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let numbers: Option<Vec<Decimal>> = parts.iter().map(|part| Decimal::parse(part)).collect();
    match (&parts[..], numbers.as_deref()) {
        ([_, _, _], Some(&[from, to, step])) => range(from, to, step),
        ([_, _], Some(_)) => Err(format!("'{text}' has no step: a range is from:to:step, like 0.5:0.9:0.1")),
        _ => Ok(list(text)),
    }
}

fn list(text: &str) -> Vec<String> {
    text.split(',').map(|value| value.trim().to_owned()).collect()
}

fn range(from: Decimal, to: Decimal, step: Decimal) -> Result<Vec<String>, String> {
    let places = from.places.max(to.places).max(step.places);
    let [first, last, step] = [from, to, step].map(|number| number.scaled(places));
    if step == 0 || (last - first).signum() == -step.signum() {
        return Err(format!(
            "a range of steps of {} never comes from {} to {}",
            Decimal { digits: step, places }.text(),
            from.text(),
            to.text()
        ));
    }
    let count = (last - first) / step + 1;
    if count > MOST {
        return Err(format!("a range of {count} values is more than {MOST}; take a larger step"));
    }
    Ok((0..count).map(|i| Decimal { digits: first + i * step, places }.text()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Vec<String> {
        values(text).unwrap()
    }

    #[test]
    fn ranges_are_decimal_and_inclusive() {
        assert_eq!(of("0.5:0.9:0.1"), ["0.5", "0.6", "0.7", "0.8", "0.9"]);
        assert_eq!(of("20:40:5"), ["20", "25", "30", "35", "40"]);
        assert_eq!(of("1:0:-0.25"), ["1.00", "0.75", "0.50", "0.25", "0.00"]);
        assert_eq!(of("-0.1:0.1:.1"), ["-0.1", "0.0", "0.1"]);
        assert_eq!(of("0:1:0.3"), ["0.0", "0.3", "0.6", "0.9"]);
        assert_eq!(of("7:7:1"), ["7"]);
        assert_eq!(of("0:1:0.001").len(), 1001);
    }

    #[test]
    fn everything_else_is_a_list() {
        assert_eq!(of("pipe, taper"), ["pipe", "taper"]);
        assert_eq!(of("0.3"), ["0.3"]);
        assert_eq!(of("17D"), ["17D"]);
        assert_eq!(of("a:b:c"), ["a:b:c"]);
    }

    #[test]
    fn ranges_that_never_end_are_refused() {
        for text in ["0:1:0", "0:1:-1", "1:0:1", "0:1", "0:1:0.0000001"] {
            assert!(values(text).is_err(), "{text}");
        }
    }
}
