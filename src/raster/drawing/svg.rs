//! Shapes → SVG 1.1.

use std::fmt::Write as _;

use glam::Vec2;

use super::{Drawing, Kind, Shape};
use crate::{Background, Landscape};

impl Drawing {
    /// The drawing as SVG: the same strokes, one unit a pixel, places to a hundredth of it. `recipe`, one
    /// line, is kept as its metadata.
    pub fn svg(&self, recipe: Option<&str>) -> String {
        let (width, height) = (self.size.width(), self.size.height());
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n"
        );
        if let Some(recipe) = recipe {
            svg += &format!("<metadata>linden recipe: {}</metadata>\n", escaped(recipe));
        }
        let whole = "width=\"100%\" height=\"100%\"";
        match self.background {
            Background::Transparent => {}
            Background::Plain(color) => svg += &format!("<rect {whole} fill=\"{}\"/>\n", hex(color)),
            Background::Gradient(top, bottom)
            | Background::Landscape(Landscape { sky: top, horizon: bottom, .. }) => {
                svg += &format!(
                    "<linearGradient id=\"paper\" x2=\"0\" y2=\"1\"><stop stop-color=\"{}\"/>\
                     <stop offset=\"1\" stop-color=\"{}\"/></linearGradient>\n\
                     <rect {whole} fill=\"url(#paper)\"/>\n",
                    hex(top),
                    hex(bottom)
                );
            }
        }
        for shape in &self.shapes {
            self.write_shape(shape, &mut svg);
        }
        for word in &self.words {
            let Vec2 { x, y } = word.at;
            // Capitals of most sans-serif fonts are 0.72 of their size.
            svg += &format!(
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-family=\"DejaVu Sans, sans-serif\" \
                 font-size=\"{:.2}\" fill=\"{}\">{}</text>\n",
                word.height / 0.729,
                hex(word.color),
                escaped(&word.text)
            );
        }
        svg + "</svg>\n"
    }

    fn write_shape(&self, shape: &Shape, svg: &mut String) {
        let color = hex(shape.color);
        *svg += "<path ";
        *svg += &match shape.kind {
            Kind::Rings => format!("fill=\"{color}\""),
            Kind::Lines { width } => format!(
                "fill=\"none\" stroke=\"{color}\" stroke-width=\"{width:.3}\" stroke-linecap=\"round\" \
                 stroke-linejoin=\"round\""
            ),
        };
        if shape.alpha < 0.999 {
            *svg += &format!(" opacity=\"{:.3}\"", shape.alpha);
        }
        *svg += " d=\"";
        for line in self.lines_of(shape).filter(|line| line.iter().all(|point| point.is_finite())) {
            for (i, point) in line.iter().enumerate() {
                // Writing to a string cannot fail.
                let _ = write!(svg, "{}{:.2} {:.2}", if i == 0 { 'M' } else { 'L' }, point.x, point.y);
            }
            if shape.kind == Kind::Rings {
                svg.push('z');
            }
        }
        *svg += "\"/>\n";
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text in XML, without the characters that it may not have.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars().filter(|c| !c.is_control()) {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            _ => escaped.push(c),
        }
    }
    escaped
}
