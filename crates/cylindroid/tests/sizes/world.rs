//! The values that arguments are drawn from, by type, and the calls.

use std::any::{Any, TypeId, type_name};
use std::collections::HashMap;
use std::fmt::{self, Debug, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::argument::Argument;
use crate::values::harvest;

/// Values of a type that stay; as many again are replaced by later results.
const STAY: usize = 24;

/// Values by type. All of them live to the end of the test: arguments borrow them.
pub(crate) struct World {
    values: HashMap<TypeId, Vec<&'static dyn Any>>,
    random: u64,
}

impl World {
    pub(crate) fn new() -> Self {
        Self { values: HashMap::new(), random: 1 }
    }

    /// A number below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        // Steele, Lea & Flood 2014.
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.random;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) % n as u64) as usize
    }

    pub(crate) fn keep<T: 'static>(&mut self, value: T) {
        let place = self.below(STAY);
        let values = self.values.entry(TypeId::of::<T>()).or_default();
        let value: &'static dyn Any = Box::leak(Box::new(value));
        if values.len() < 2 * STAY {
            values.push(value);
        } else {
            values[STAY + place] = value;
        }
    }

    /// One of the values of a type.
    pub(crate) fn one<T: 'static>(&mut self) -> Option<&'static T> {
        let count = self.values.get(&TypeId::of::<T>())?.len();
        let place = self.below(count);
        self.values[&TypeId::of::<T>()][place].downcast_ref()
    }

    pub(crate) fn of<T: Clone>(&mut self, values: &[T]) -> T {
        let place = self.below(values.len());
        values[place].clone()
    }
}

pub(crate) enum Outcome {
    Returned,
    /// No value of the type of an argument.
    Missing(&'static str),
    /// The arguments.
    Panicked(String),
}

/// A function and its name.
pub(crate) struct Function {
    pub(crate) path: &'static str,
    call: Box<dyn Fn(&mut World) -> Outcome>,
}

impl Function {
    pub(crate) fn new<A>(path: &'static str, function: impl Call<A> + 'static) -> Self {
        Self { path, call: Box::new(move |world| function.call(world)) }
    }

    pub(crate) fn call(&self, world: &mut World) -> Outcome {
        (self.call)(world)
    }
}

/// A function whose arguments can be drawn.
pub(crate) trait Call<A> {
    fn call(&self, world: &mut World) -> Outcome;
}

macro_rules! call {
    ($($name:ident: $type:ident),*) => {
        impl<F, R: 'static, $($type: Argument),*> Call<($($type,)*)> for F
        where
            F: Fn($($type),*) -> R,
        {
            fn call(&self, world: &mut World) -> Outcome {
                let _ = &world;
                #[allow(unused_mut)] // of no arguments
                let mut arguments = Short(String::new());
                $(
                    let Some($name) = $type::draw(world) else {
                        return Outcome::Missing(type_name::<$type>());
                    };
                    arguments.add(&$name);
                )*
                match catch_unwind(AssertUnwindSafe(|| self($($name),*))) {
                    Ok(result) => {
                        harvest(world, &result);
                        Outcome::Returned
                    }
                    Err(_) => Outcome::Panicked(arguments.0),
                }
            }
        }
    };
}
call!();
call!(a: A);
call!(a: A, b: B);
call!(a: A, b: B, c: C);
call!(a: A, b: B, c: C, d: D);
call!(a: A, b: B, c: C, d: D, e: E);

/// The beginnings of arguments.
struct Short(String);

impl Short {
    fn add(&mut self, argument: &dyn Debug) {
        if !self.0.is_empty() {
            self.0.push_str(", ");
        }
        let mut one = Beginning { text: &mut self.0, left: 160 };
        if write!(one, "{argument:?}").is_err() {
            self.0.push_str("...");
        }
    }
}

/// Writes no more than `left` characters.
struct Beginning<'a> {
    text: &'a mut String,
    left: usize,
}

impl Write for Beginning<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let count = text.chars().count();
        self.text.extend(text.chars().take(self.left));
        self.left = self.left.saturating_sub(count);
        if self.left == 0 { Err(fmt::Error) } else { Ok(()) }
    }
}
