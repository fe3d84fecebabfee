//! More stations where the shape needs them.

use super::path::Station;

/// Puts stations at arc lengths, metres, in rising order, on the straight lines between those that are
/// there. Places beyond the apex, and such as coincide with a station, are left out.
pub(super) fn insert(stations: &mut Vec<Station>, places: impl Iterator<Item = f32>) {
    let mut places = places.peekable();
    let coarse = std::mem::take(stations);
    let mut start = 0.0;
    for pair in coarse.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        stations.push(from);
        let length = from.position.distance(to.position);
        // A ring closer to the next one would only be passed over.
        let room = from.onward.min(to.radius) * 0.05;
        while let Some(place) = places.next_if(|&place| place < start + length) {
            let within = place - start;
            if within > room && length - within > room {
                stations.push(from.toward(&to, within / length));
            }
        }
        start += length;
    }
    stations.extend(coarse.last());
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn stations_come_where_they_are_asked_for_and_the_line_stays() {
        let station = |y: f32| Station::new(Vec3::Y * y, 0.1 * (3.0 - y));
        let mut stations = vec![station(0.0), station(1.0), station(2.0)];
        insert(&mut stations, [0.25, 0.5, 1.0, 1.5, 7.0].into_iter());
        let heights: Vec<f32> = stations.iter().map(|found| found.position.y).collect();
        assert_eq!(heights, [0.0, 0.25, 0.5, 1.0, 1.5, 2.0]);
        for found in stations {
            assert!((found.radius - station(found.position.y).radius).abs() < 1e-6);
        }
    }
}
