//! The links of points with their nearest.

use glam::DVec3;
use rayon::prelude::*;

use super::cells::{Cells, Near};
use super::neighbours::Neighbours;
use linden_base::monitor::{Cancelled, Monitor};

/// Links per point: enough to close a ring of points around a stem.
const LINKS: usize = 12;

/// Points between two looks at the monitor.
const POINTS_PER_CHECK: usize = 1024;

/// Of each point the nearest others, then itself in what is left.
pub(super) type LinkedTo = [u32; LINKS];

/// Within this part of the reach there mostly are as many as links are made to.
const FULL: f32 = 0.65;

/// The nearest points of each within `reach`, and what `weigh` makes of all that are so near, itself among them.
pub(super) fn links_within(
    points: &[DVec3],
    reach: f64,
    weigh: impl Fn(&[Near]) -> u32 + Sync,
    monitor: &dyn Monitor,
) -> Result<(Vec<LinkedTo>, Vec<u32>), Cancelled> {
    let full = (FULL * reach as f32) * (FULL * reach as f32);
    let of_point = |from: u32, near: &mut Vec<Near>| {
        let weight = weigh(near);
        let mut nearest = [from; LINKS];
        if near.iter().filter(|near| near.squared_m() < full).count() > LINKS {
            near.retain(|near| near.squared_m() < full);
        }
        near.retain(|near| near.index() != from);
        if near.len() > LINKS {
            near.select_nth_unstable(LINKS);
        }
        for (nearest, near) in nearest.iter_mut().zip(&*near) {
            *nearest = near.index();
        }
        (nearest, weight)
    };
    Ok(Cells::new(points, reach).map(of_point, monitor)?.into_iter().unzip())
}

/// The same without the points that are marked, counted anew.
pub(super) fn without(mut nearest: Vec<LinkedTo>, is_marked: &[bool]) -> Vec<LinkedTo> {
    let mut left = 0;
    let places: Vec<u32> = is_marked
        .iter()
        .map(|&is_marked| {
            let place = left;
            left += u32::from(!is_marked);
            if is_marked { u32::MAX } else { place }
        })
        .collect();
    let mut from = 0;
    nearest.retain_mut(|nearest| {
        let place = places[from];
        for to in &mut *nearest {
            let left = places[*to as usize];
            *to = if left == u32::MAX { place } else { left };
        }
        from += 1;
        place != u32::MAX
    });
    nearest
}

/// Links of each point with its nearest, in both directions, and others: where those of each go, and where they begin.
pub(super) fn by_point(nearest: &[LinkedTo], others: &[(u32, u32)]) -> (Vec<u32>, Vec<usize>) {
    let of_nearest = || {
        let links = (0..).zip(nearest).flat_map(|(from, list)| list.iter().map(move |&to| (from, to)));
        links.filter(|&(from, to)| to != from)
    };
    // Those that are mutual stand in both lists.
    let is_one_way = |&(from, to): &(u32, u32)| !nearest[to as usize].contains(&from);
    let back: Vec<(u32, u32)> = of_nearest().filter(is_one_way).map(|(from, to)| (to, from)).collect();
    let all = || of_nearest().chain(back.iter().copied()).chain(others.iter().copied());
    let mut starts = vec![0; nearest.len() + 1];
    for (from, _) in all() {
        starts[from as usize + 1] += 1;
    }
    for point in 0..nearest.len() {
        starts[point + 1] += starts[point];
    }
    let mut next = starts.clone();
    let mut links = vec![0; starts[nearest.len()]];
    for (from, to) in all() {
        let slot = &mut next[from as usize];
        links[*slot] = to;
        *slot += 1;
    }
    (links, starts)
}

/// Which points have no two others nearby: dust, birds, scattered pulses. `None` for a cloud so thin that all of it looks
/// like that: it is meant to be so.
pub(super) fn strays(
    points: &[DVec3],
    nearest: &[LinkedTo],
    reach: f64,
    monitor: &dyn Monitor,
) -> Result<Option<Vec<bool>>, Cancelled> {
    // The few that have no two within reach are searched for farther off.
    let is_lonely = |(from, nearest): (u32, &LinkedTo)| nearest.iter().filter(|&&to| to != from).count() < 2;
    let lonely = (0..).zip(nearest).filter(|&one| is_lonely(one)).map(|(from, _)| from);
    let lonely: Vec<u32> = lonely.collect();
    if lonely.is_empty() {
        return Ok(None);
    }
    let tree = Neighbours::new(points, monitor)?;
    let of_some = |some: &[u32]| {
        monitor.check()?;
        let mut found = Vec::new();
        let mut is_stray = |from: &u32| {
            tree.nearest(points[*from as usize], 3, 2.0 * reach, &mut found);
            found.len() < 3
        };
        Ok(some.iter().copied().filter(&mut is_stray).collect())
    };
    let strays: Vec<Vec<u32>> =
        lonely.par_chunks(POINTS_PER_CHECK).map(of_some).collect::<Result<_, Cancelled>>()?;
    let strays = strays.concat();
    if strays.is_empty() || strays.len() * 2 > points.len() {
        return Ok(None);
    }
    let mut is_stray = vec![false; points.len()];
    for stray in strays {
        is_stray[stray as usize] = true;
    }
    Ok(Some(is_stray))
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    fn scattered(count: u64) -> Vec<DVec3> {
        let point = |i| DVec3::from([0, 1, 2].map(|axis| Key::new(3).child(i).child(axis).unit()));
        (0..count).map(point).collect()
    }

    fn links_of(points: &[DVec3], from: usize, reach: f64) -> Vec<u32> {
        let mut all: Vec<(f64, u32)> = points.iter().map(|p| p.distance(points[from])).zip(0..).collect();
        all.retain(|&(away, to)| away < reach && to as usize != from);
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.truncate(LINKS);
        let mut nearest: Vec<u32> = all.iter().map(|&(_, to)| to).collect();
        nearest.sort_unstable();
        nearest
    }

    #[test]
    fn links_lead_to_the_nearest_and_back() {
        let points = scattered(700);
        for reach in [0.05, 0.12, 0.3] {
            let (nearest, near) = links_within(&points, reach, |near| near.len() as u32, &Quiet).unwrap();
            let mut pairs: Vec<(u32, u32)> = Vec::new();
            for (from, found) in nearest.iter().enumerate() {
                let mut found: Vec<u32> = found.iter().copied().filter(|&to| to as usize != from).collect();
                found.sort_unstable();
                assert_eq!(found, links_of(&points, from, reach));
                let around = points.iter().filter(|p| p.distance(points[from]) < reach).count();
                assert_eq!(near[from] as usize, around);
                pairs.extend(found.iter().flat_map(|&to| [(from as u32, to), (to, from as u32)]));
            }
            pairs.extend([(0, 1), (1, 0)]);
            pairs.sort_unstable();
            pairs.dedup();
            let bridge = if pairs.contains(&(0, 1)) && nearest[0].contains(&1) {
                vec![]
            } else {
                vec![(0, 1), (1, 0)]
            };
            let (links, starts) = by_point(&nearest, &bridge);
            let mut found: Vec<(u32, u32)> = (0..points.len())
                .flat_map(|from| {
                    links[starts[from]..starts[from + 1]].iter().map(move |&to| (from as u32, to))
                })
                .collect();
            found.sort_unstable();
            found.dedup();
            assert_eq!(found, pairs);
        }
    }

    #[test]
    fn what_is_taken_out_is_linked_no_more_and_all_else_is() {
        let points = scattered(400);
        let (nearest, _) = links_within(&points, 0.2, |_| 0, &Quiet).unwrap();
        let is_out: Vec<bool> = (0..points.len()).map(|i| i % 7 == 3).collect();
        let kept: Vec<usize> = (0..points.len()).filter(|&i| !is_out[i]).collect();
        let left = without(nearest.clone(), &is_out);
        assert_eq!(left.len(), kept.len());
        for (place, (&from, left)) in kept.iter().zip(&left).enumerate() {
            let given = nearest[from].iter().filter(|&&to| to as usize != from && !is_out[to as usize]);
            let found = left.iter().filter(|&&to| to as usize != place).map(|&to| kept[to as usize] as u32);
            assert_eq!(found.collect::<Vec<u32>>(), given.copied().collect::<Vec<u32>>());
        }
    }
}
