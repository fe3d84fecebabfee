//! What the buffer is written into: a file, or base64 inside one.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::{ExportError, Sink};

/// Takes the buffer's bytes in order.
pub(crate) trait ByteSink {
    fn put(&mut self, bytes: &[u8]) -> Result<(), ExportError>;
}

impl ByteSink for Sink<'_> {
    fn put(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        self.write(bytes)
    }
}

/// Writes bytes as base64 into a sink.
pub(crate) struct Base64<'s, 'a> {
    out: &'s mut Sink<'a>,
    /// Up to two bytes that wait for a third.
    rest: Vec<u8>,
    text: String,
}

impl<'s, 'a> Base64<'s, 'a> {
    pub fn new(out: &'s mut Sink<'a>) -> Self {
        Self { out, rest: Vec::new(), text: String::new() }
    }

    pub fn finish(mut self) -> Result<(), ExportError> {
        let rest = std::mem::take(&mut self.rest);
        self.encode(&rest)
    }

    fn encode(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        self.text.clear();
        STANDARD.encode_string(bytes, &mut self.text);
        self.out.write(self.text.as_bytes())
    }
}

impl ByteSink for Base64<'_, '_> {
    fn put(&mut self, mut bytes: &[u8]) -> Result<(), ExportError> {
        while !self.rest.is_empty() && self.rest.len() < 3 && !bytes.is_empty() {
            self.rest.push(bytes[0]);
            bytes = &bytes[1..];
        }
        if self.rest.len() == 3 {
            let rest = std::mem::take(&mut self.rest);
            self.encode(&rest)?;
        }
        let whole = bytes.len() - bytes.len() % 3;
        for piece in bytes[..whole].chunks(3 << 16) {
            self.encode(piece)?;
        }
        self.rest.extend_from_slice(&bytes[whole..]);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bundle;
    use crate::bundle::test_output::Output;

    #[test]
    fn base64_does_not_depend_on_the_pieces() {
        let bytes: Vec<u8> = (0..1000).map(|i| (i * 7 % 256) as u8).collect();
        for piece in [1, 2, 3, 4, 5, 64, 1000] {
            let output = Output::default();
            Bundle::stream("test", output.clone())
                .write_main(None, &linden_pipeline::Quiet, |out| {
                    let mut encoder = Base64::new(out);
                    bytes.chunks(piece).try_for_each(|piece| encoder.put(piece))?;
                    encoder.finish()
                })
                .unwrap();
            assert_eq!(output.bytes(), STANDARD.encode(&bytes).into_bytes(), "pieces of {piece}");
        }
    }
}
