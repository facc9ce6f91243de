//! Rectangles side by side in a texture.

/// Rectangles begin at multiples of four texels, as compressed textures have blocks of 4 x 4.
const GRID: u32 = 4;

/// Where rectangles lie in a texture.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Packed {
    /// Width and height of the texture, powers of two.
    pub(super) size: [u32; 2],
    /// The upper left corner of each.
    pub(super) places: Vec<[u32; 2]>,
}

/// Lays rectangles in rows, the highest first, in the smallest texture that holds them so; none if that would be
/// wider or higher than `most`.
pub(super) fn packed(rectangles: &[[u32; 2]], most: u32) -> Option<Packed> {
    let padded: Vec<[u32; 2]> = (rectangles.iter())
        .map(|sides| sides.map(|side| side.next_multiple_of(GRID)))
        .collect();
    let mut order: Vec<usize> = (0..padded.len()).collect();
    order.sort_by_key(|&k| {
        let [width, height] = padded[k];
        (u32::MAX - height, u32::MAX - width, k)
    });
    let widths = (0..).map(|k| GRID << k).take_while(|width| *width <= most);
    let of_width = |width: u32| {
        let mut places = vec![[0; 2]; padded.len()];
        let ([mut x, mut y], mut row) = ([0, 0], 0);
        for &k in &order {
            let [own_width, own_height] = padded[k];
            if x + own_width > width {
                (x, y) = (0, y + row);
                row = 0;
            }
            if own_width > width || y + own_height > most {
                return None;
            }
            places[k] = [x, y];
            x += own_width;
            row = row.max(own_height);
        }
        let size = [width, (y + row).max(GRID).next_power_of_two()];
        Some(Packed { size, places })
    };
    widths
        .filter_map(of_width)
        .filter(|packed| packed.size[1] <= most)
        .min_by_key(|packed| {
            let [width, height] = packed.size;
            (width * height, width.max(height))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_lie_apart_in_a_texture_of_powers_of_two() {
        let sides = |k: u32| [3 + 7 * k % 90, 5 + 13 * k % 40];
        let rectangles: Vec<[u32; 2]> = (0..70).map(sides).collect();
        let Packed { size, places } = packed(&rectangles, 512).unwrap();
        assert!(
            size.iter()
                .all(|side| side.is_power_of_two() && *side <= 512)
        );
        let mut is_taken = vec![false; (size[0] * size[1]) as usize];
        for ([width, height], [x, y]) in rectangles.iter().zip(&places) {
            assert!(x % GRID == 0 && y % GRID == 0);
            for at in 0..width * height {
                let texel = (y + at / width) * size[0] + x + at % width;
                assert!(!is_taken[texel as usize], "two in one texel");
                is_taken[texel as usize] = true;
            }
        }
        let filled = is_taken.iter().filter(|taken| **taken).count();
        assert!(
            filled * 4 > is_taken.len(),
            "{filled} of {}",
            is_taken.len()
        );
    }

    #[test]
    fn what_does_not_fit_is_not_laid_down() {
        assert_eq!(packed(&[[65, 8]], 64), None);
        assert_eq!(packed(&[[64, 32]; 3], 64), None);
        let two = packed(&[[64, 32]; 2], 64).unwrap();
        assert_eq!((two.size, two.places), ([64, 64], vec![[0, 0], [0, 32]]));
    }
}
