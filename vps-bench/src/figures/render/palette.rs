//! Colour quantization by median cut, for small files.

use std::collections::BTreeMap;

/// Red, green and blue.
type Rgb = [u8; 3];

/// The largest palette of a PNG file.
const MAX_COLORS: usize = 256;

/// Colours close to each other, with the number of pixels of each.
struct ColorBox(Vec<(Rgb, u32)>);

impl ColorBox {
    /// The channel of the largest range, and that range.
    fn widest_channel(&self) -> (usize, u8) {
        let range = |channel: usize| {
            let values = || self.0.iter().map(|(color, _)| color[channel]);
            values().max().unwrap_or(0) - values().min().unwrap_or(0)
        };
        let ranges = [0, 1, 2].map(|channel| (channel, range(channel)));
        let [a, b, c] = ranges;
        let longer = |a: (usize, u8), b: (usize, u8)| if b.1 > a.1 { b } else { a };
        longer(longer(a, b), c)
    }

    /// Rare colours weigh more than their pixels, so that small details stay visible.
    fn weight(count: u32) -> f64 {
        f64::from(count).sqrt()
    }

    /// The error that splitting reduces.
    fn error(&self) -> f64 {
        let weight: f64 = self.0.iter().map(|(_, count)| Self::weight(*count)).sum();
        f64::from(self.widest_channel().1).powi(2) * weight
    }

    /// Splits it in two boxes of about the same weight.
    fn split(mut self) -> [Self; 2] {
        let (channel, _) = self.widest_channel();
        self.0.sort_by_key(|(color, _)| (color[channel], *color));
        let half = 0.5 * self.0.iter().map(|c| Self::weight(c.1)).sum::<f64>();
        let mut sum = 0.0;
        let before = self.0.iter().take_while(|(_, count)| {
            sum += Self::weight(*count);
            sum <= half
        });
        let at = before.count().clamp(1, self.0.len() - 1);
        let rest = self.0.split_off(at);
        [self, Self(rest)]
    }

    fn mean(&self) -> Rgb {
        let count: u64 = self.0.iter().map(|c| u64::from(c.1)).sum();
        [0, 1, 2].map(|channel| {
            let sum = self
                .0
                .iter()
                .map(|(color, count)| u64::from(color[channel]) * u64::from(*count));
            ((sum.sum::<u64>() + count / 2) / count.max(1)) as u8
        })
    }
}

/// At most 256 colours, and the index of each pixel's colour.
pub(super) fn palette(pixels: impl Iterator<Item = Rgb> + Clone) -> (Vec<Rgb>, Vec<u8>) {
    let mut counts: BTreeMap<Rgb, u32> = BTreeMap::new();
    for color in pixels.clone() {
        *counts.entry(color).or_default() += 1;
    }
    let mut boxes = vec![ColorBox(counts.into_iter().collect())];
    while boxes.len() < MAX_COLORS {
        let errors = boxes.iter().map(ColorBox::error).enumerate();
        let worst = errors.max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((at, _)) = worst.filter(|(_, error)| *error > 0.0) else {
            break;
        };
        let halves = boxes.swap_remove(at).split();
        boxes.extend(halves);
    }
    let mut index = BTreeMap::new();
    for (i, color_box) in boxes.iter().enumerate() {
        index.extend(color_box.0.iter().map(|(color, _)| (*color, i as u8)));
    }
    let indices = pixels.map(|color| index[&color]).collect();
    (boxes.iter().map(ColorBox::mean).collect(), indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(pixels: &[Rgb]) -> (usize, Vec<Rgb>) {
        let (colors, indices) = palette(pixels.iter().copied());
        let shown = indices.iter().map(|i| colors[usize::from(*i)]).collect();
        (colors.len(), shown)
    }

    #[test]
    fn few_colors_are_kept() {
        let pixels: Vec<Rgb> = (0..200).map(|i| [i, 255 - i, i / 2]).collect();
        assert_eq!(shown(&pixels), (200, pixels));
    }

    #[test]
    fn many_colors_are_hardly_changed() {
        let grey = (0..=255).flat_map(|v| [[v, v, v]; 100]);
        let tints = (0..=255).map(|v| [v, v / 2, 0]);
        let pixels: Vec<Rgb> = grey.chain(tints).collect();
        let (count, shown) = shown(&pixels);
        assert_eq!(count, MAX_COLORS);
        for (a, b) in pixels.iter().zip(&shown) {
            let differences = [0, 1, 2].map(|i| a[i].abs_diff(b[i]));
            assert!(differences.iter().all(|d| *d <= 6), "{a:?} {b:?}");
        }
    }
}
