//! Random changes of files.

/// Words that mean something to a reader.
const WORDS: [&str; 36] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "1e120",
    "0",
    "-0.0",
    "18446744073709551616",
    "-1",
    "\"",
    "'",
    "<",
    ">",
    "/>",
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<?",
    "&#0;",
    "&lt;",
    "\0",
    "\u{fffd}",
    "\u{feff}",
    "name=\"\"",
    "<a>",
    "</a>",
    "[[joint]]\n",
    "[dh]\n",
    "= [",
    "]",
    "{",
    "\r\n",
    "\u{202e}",
];

pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `n`; 0 for 0.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// A range of at most `longest`, more often a short one.
    fn range(&mut self, length: usize, longest: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        let longest = 1 + self.below(longest);
        start..(start + self.below(longest + 1)).min(length)
    }
}

/// One to four changes: bytes, numbers, words, and parts removed, doubled, moved or taken from
/// another file.
pub(crate) fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..=random.below(4) {
        let part = random.range(bytes.len(), 300);
        match random.below(9) {
            0 if !bytes.is_empty() => {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
            1 if !bytes.is_empty() => {
                let at = random.below(bytes.len());
                bytes[at] = random.next() as u8;
            }
            2 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(part.start..part.start, word.bytes());
            }
            // A number becomes a word.
            3 => {
                let is_number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
                let from = bytes[part.start..].iter().position(u8::is_ascii_digit);
                let Some(from) = from.map(|i| part.start + i) else { continue };
                let length = bytes[from..].iter().take_while(|b| is_number(b)).count();
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(from..from + length, word.bytes());
            }
            4 => drop(bytes.drain(part)),
            5 => {
                let copy = bytes[part.clone()].repeat(1 + random.below(3));
                bytes.splice(part.end..part.end, copy);
            }
            6 => {
                let moved: Vec<u8> = bytes.drain(part).collect();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, moved);
            }
            7 => {
                let from = random.range(other.len(), 300);
                bytes.splice(part, other[from].iter().copied());
            }
            _ => bytes.truncate(bytes.len() - random.below(bytes.len().min(300))),
        }
    }
}
