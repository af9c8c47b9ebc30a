//! Several canvases with text, as a PNG file.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use vps_build::write_atomically;

use crate::figures::font::{FONT, register_fonts};
use crate::figures::render::canvas::{Canvas, SUPERSAMPLING};
use crate::figures::render::colors::Color;
use crate::figures::render::palette::palette;

/// The horizontal alignment of a text at its position.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Anchor {
    Left,
    Middle,
}

/// A picture at its final size.
pub(crate) struct FigureSheet {
    size: (u32, u32),
    /// Red, green and blue of each pixel.
    bytes: Vec<u8>,
}

fn bytes_of(color: Color) -> [u8; 3] {
    // Few steps, which the eye does not see, make small files.
    let step = |c: f32| (c.clamp(0.0, 1.0) * 63.0).round() as u32;
    color.to_array().map(|c| (step(c) * 255 / 63) as u8)
}

impl FigureSheet {
    /// A white sheet.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self {
            size: (width, height),
            bytes: vec![255; 3 * (width * height) as usize],
        }
    }

    fn set_pixel(&mut self, [x, y]: [u32; 2], color: Color) {
        if x < self.size.0 && y < self.size.1 {
            let at = 3 * (y * self.size.0 + x) as usize;
            self.bytes[at..at + 3].copy_from_slice(&bytes_of(color));
        }
    }

    /// Places a canvas with its upper left corner at a position, averaging its samples.
    pub(crate) fn place(&mut self, canvas: &Canvas, [left, top]: [u32; 2]) {
        let [width, height] = canvas.size().map(|n| n / SUPERSAMPLING);
        for y in 0..height {
            for x in 0..width {
                let mut sum = Color::ZERO;
                for i in 0..SUPERSAMPLING * SUPERSAMPLING {
                    sum += canvas.color(
                        x * SUPERSAMPLING + i % SUPERSAMPLING,
                        y * SUPERSAMPLING + i / SUPERSAMPLING,
                    );
                }
                self.set_pixel(
                    [left + x, top + y],
                    sum / (SUPERSAMPLING * SUPERSAMPLING) as f32,
                );
            }
        }
    }

    /// Draws a filled rectangle.
    pub(crate) fn rectangle(&mut self, [left, top]: [u32; 2], size: [u32; 2], color: Color) {
        for y in top..top + size[1] {
            for x in left..left + size[0] {
                self.set_pixel([x, y], color);
            }
        }
    }

    /// Draws a line of text whose upper side is at a position.
    pub(crate) fn text(
        &mut self,
        text: &str,
        at: [u32; 2],
        anchor: Anchor,
        pixels: u32,
    ) -> Result<(), String> {
        register_fonts();
        let horizontal = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle => HPos::Center,
        };
        let style = TextStyle::from((FONT, pixels)).pos(Pos::new(horizontal, VPos::Top));
        let area = BitMapBackend::with_buffer(&mut self.bytes, self.size).into_drawing_area();
        let text = Text::new(text, (at[0] as i32, at[1] as i32), style);
        area.draw(&text).map_err(|e| e.to_string())?;
        area.present().map_err(|e| e.to_string())
    }

    /// Writes a PNG file of at most 256 colours, which is much smaller than one of all colours.
    pub(crate) fn write(&self, path: &Path) -> Result<(), String> {
        let named = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let pixels = self.bytes.chunks_exact(3).map(|c| [c[0], c[1], c[2]]);
        let (palette, indices) = palette(pixels);
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.size.0, self.size.1);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette.concat());
        encoder.set_compression(png::Compression::Best);
        encoder.set_filter(png::FilterType::NoFilter);
        let written = encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(&indices));
        written.map_err(|e| named(&e))?;
        write_atomically(path, &file).map_err(|e| named(&e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::render::colors;
    use crate::figures::render::view::View;
    use vps_core::Vec3;

    #[test]
    fn a_written_sheet_holds_its_drawing() {
        let path =
            std::env::temp_dir().join(format!("vps-figure-sheet-{}.png", std::process::id()));
        let mut canvas = Canvas::new(20, 20);
        let view = View::from(0.0, 0.0, Vec3::ZERO, 1.0);
        canvas.ball(&view, Vec3::ZERO, 0.3, colors::BLUE);
        let mut sheet = FigureSheet::new(60, 40);
        sheet.place(&canvas, [30, 10]);
        let before = sheet.bytes.clone();
        sheet.text("A text", [2, 2], Anchor::Left, 14).unwrap();
        assert!(sheet.bytes != before);
        sheet.write(&path).unwrap();
        let file = std::fs::File::open(&path).unwrap();
        let mut decoder = png::Decoder::new(file);
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size()];
        reader.next_frame(&mut bytes).unwrap();
        let differences = bytes.iter().zip(&sheet.bytes).map(|(a, b)| a.abs_diff(*b));
        assert!(differences.max().unwrap() <= 12);
        let at = |x: usize, y: usize| bytes[3 * (y * 60 + x)];
        assert!(at(40, 20) < 100 && at(31, 11) == 255);
        std::fs::remove_file(&path).unwrap();
    }
}
