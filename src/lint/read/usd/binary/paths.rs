//! Paths: a tree, each before those below it.

use openusd::sdf::Path;

use super::super::layer::DEEPEST;
use super::super::{ReadError, beyond, broken};
use super::bytes::{Bytes, Room};
use super::packed::integers;
use super::sections::Names;

pub(super) const WHAT: &str = "the section PATHS";
/// Longer than any: paths below paths could be as long as the file, each.
const LONGEST: usize = 4096;

/// All paths by their numbers.
pub(super) fn read(mut bytes: Bytes<'_>, names: &Names, room: &mut Room<'_>) -> Result<Vec<Path>, ReadError> {
    let all = bytes.count()?;
    // The empty path has a number and no place in the tree.
    let count = bytes.count()?;
    let numbers: Vec<u32> = integers(bytes.counted()?, count, WHAT, room)?;
    let elements: Vec<i32> = integers(bytes.counted()?, count, WHAT, room)?;
    let jumps: Vec<i32> = integers(bytes.counted()?, count, WHAT, room)?;
    room.take(all, size_of::<Path>())?;
    let mut paths = vec![Path::default(); all];
    let astray = || broken("the tree of paths leads to one that is not there, or in a circle");
    // Where in the lists, the path above it, and how deep that is.
    let mut open = vec![(0_usize, String::new(), 0)];
    let mut seen = 0;
    while let Some((mut at, mut above, mut depth)) = open.pop() {
        loop {
            let (Some(&number), Some(&element), Some(&jump)) =
                (numbers.get(at), elements.get(at), jumps.get(at))
            else {
                return Err(astray());
            };
            seen += 1;
            let path = if above.is_empty() {
                "/".to_owned()
            } else {
                let name = names.token(element.unsigned_abs())?;
                joined(&above, name, element < 0)?
            };
            room.take(path.len(), 1)?;
            let place = paths.get_mut(number as usize).filter(|_| seen <= count).ok_or_else(astray)?;
            *place = Path::new(&path).map_err(|_| astray())?;
            // -2: neither a path below nor a sibling; -1: only what is below; 0: only a sibling, which is next; otherwise
            // both, and how far it is to the sibling.
            let has_below = jump == -1 || jump > 0;
            if jump > 0 {
                room.take(above.len(), 1)?;
                open.push((at.saturating_add(jump as usize), above.clone(), depth));
            }
            if jump < -1 {
                break;
            }
            if has_below {
                above = path;
                depth += 1;
                if depth > DEEPEST {
                    return Err(beyond(format!("it is nested deeper than {DEEPEST}")));
                }
            }
            at += 1;
        }
    }
    Ok(paths)
}

fn joined(above: &str, name: &str, is_property: bool) -> Result<String, ReadError> {
    let between = if is_property {
        "."
    } else if above.ends_with(['/', '}']) || name.starts_with(['{', '[', '.']) {
        // What is in a variant follows on its brace.
        ""
    } else {
        "/"
    };
    let length = above.len() + between.len() + name.len();
    if name.is_empty() || length > LONGEST {
        return Err(broken(format!("a path is without a name, or longer than {LONGEST} letters")));
    }
    Ok([above, between, name].concat())
}
