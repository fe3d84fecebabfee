//! Numbers as text: thousands in groups, metres to three digits.

/// `12 345`.
pub fn thousands(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            // A narrow no-break space would be typographically right; few terminal fonts have it.
            text.push(' ');
        }
        text.push(c);
    }
    text
}

/// Metres to three digits.
pub fn metres(m: f64) -> String {
    let digits = if m >= 100.0 {
        0
    } else if m >= 10.0 {
        1
    } else if m >= 1.0 {
        2
    } else {
        3
    };
    format!("{m:.digits$}")
}

/// An amount of bytes, to two or three digits.
pub fn length(bytes: u64) -> String {
    let (mut amount, mut unit) = (bytes as f64, "B");
    for larger in ["KiB", "MiB", "GiB", "TiB"] {
        if amount >= 999.5 {
            (amount, unit) = (amount / 1024.0, larger);
        }
    }
    let digits = usize::from(amount < 9.95 && unit != "B");
    format!("{amount:.digits$} {unit}")
}
