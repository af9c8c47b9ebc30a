//! Colours that can be told apart, also with colour blindness.

use vps_core::Vec3;

/// Red, green and blue, from 0 to 1.
pub(crate) type Color = Vec3;

pub(crate) const WHITE: Color = Vec3::ONE;
pub(crate) const INK: Color = rgb(0x22_2222);
pub(crate) const GREY: Color = rgb(0x99_9999);
pub(crate) const PALE: Color = rgb(0xde_e2e6);
pub(crate) const BLUE: Color = rgb(0x00_72b2);
pub(crate) const SKY: Color = rgb(0x56_b4e9);
pub(crate) const ORANGE: Color = rgb(0xe6_9f00);
pub(crate) const VERMILION: Color = rgb(0xd5_5e00);

/// The palette of Okabe and Ito.
const CATEGORICAL: [Color; 7] = [
    SKY,
    ORANGE,
    rgb(0x00_9e73),
    rgb(0xcc_79a7),
    BLUE,
    VERMILION,
    rgb(0xf0_e442),
];

/// From dark and low to light and high, perceptually about uniform (viridis).
const RAMP: [Color; 6] = [
    rgb(0x44_0154),
    rgb(0x41_4487),
    rgb(0x2a_788e),
    rgb(0x22_a884),
    rgb(0x7a_d151),
    rgb(0xfd_e725),
];

const fn rgb(code: u32) -> Color {
    let [_, r, g, b] = code.to_be_bytes();
    Vec3::new(r as f32 / 255.0, g as f32 / 255.0, b as f32 / 255.0)
}

/// A categorical colour, unlike those of neighbouring numbers. After seven the colours repeat,
/// lighter or darker.
pub(crate) fn categorical(n: usize) -> Color {
    let color = CATEGORICAL[n % CATEGORICAL.len()];
    match n / CATEGORICAL.len() % 3 {
        0 => color,
        1 => color.lerp(WHITE, 0.45),
        _ => color * 0.6,
    }
}

/// A colour of the ramp at `t` from 0 to 1.
pub(crate) fn ramp(t: f32) -> Color {
    let at = t.clamp(0.0, 1.0) * (RAMP.len() - 1) as f32;
    let first = (at as usize).min(RAMP.len() - 2);
    RAMP[first].lerp(RAMP[first + 1], at - first as f32)
}
