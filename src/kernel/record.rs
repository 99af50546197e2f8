//! A macro that declares a record once and generates the Rust struct, its fields as data, and its WGSL text.

use super::Real;

/// A type that host and shaders share.
pub trait Shared: Copy {
    /// Name in WGSL, such as `vec3f`.
    fn wgsl() -> String;
    /// Appends the value as the words that shaders read.
    fn write(&self, words: &mut Vec<u32>);
}

/// A struct that host and shaders share, declared by `record!`.
pub trait Record: Shared {
    /// In order.
    fn fields() -> Vec<Field>;

    /// The declaration in WGSL.
    fn declaration() -> String {
        let mut text = format!("struct {} {{\n", Self::wgsl());
        for field in Self::fields() {
            text += &format!("    {}: {},\n", field.name, field.wgsl);
        }
        text + "}\n"
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// The same in Rust and WGSL.
    pub name: &'static str,
    /// Type in WGSL.
    pub wgsl: String,
    /// Offset in the Rust struct, bytes.
    pub offset: usize,
}

/// A slice of records as the words of a shader's array.
pub fn words_of<T: Shared>(items: &[T]) -> Vec<u32> {
    let mut words = Vec::with_capacity(size_of_val(items) / size_of::<u32>());
    items.iter().for_each(|item| item.write(&mut words));
    words
}

/// Implements [`Shared`] for types with a name in WGSL.
macro_rules! shared {
    ($($type:ty = $name:literal, $self:ident => $words:expr;)*) => {
        $(impl Shared for $type {
            fn wgsl() -> String {
                $name.to_owned()
            }
            fn write(&$self, words: &mut Vec<u32>) {
                words.extend($words);
            }
        })*
    };
}

shared! {
    u32 = "u32", self => [*self];
    [u32; 2] = "vec2u", self => *self;
    [u32; 3] = "vec3u", self => *self;
    [u32; 4] = "vec4u", self => *self;
    f32 = "f32", self => [self.to_bits()];
    [f32; 2] = "vec2f", self => self.map(f32::to_bits);
    [f32; 3] = "vec3f", self => self.map(f32::to_bits);
    [f32; 4] = "vec4f", self => self.map(f32::to_bits);
}

impl<const N: usize> Shared for [[f32; 4]; N] {
    fn wgsl() -> String {
        format!("array<vec4f, {N}>")
    }
    fn write(&self, words: &mut Vec<u32>) {
        self.iter().for_each(|item| item.write(words));
    }
}

impl<T: Record, const N: usize> Shared for [T; N] {
    fn wgsl() -> String {
        format!("array<{}, {N}>", T::wgsl())
    }
    fn write(&self, words: &mut Vec<u32>) {
        self.iter().for_each(|item| item.write(words));
    }
}

/// Columns of numbers from which a packet loads record fields, one record per lane.
pub trait Columns<R>: Sized {
    /// One number per lane.
    type Number;
    /// One vector per lane.
    type Vector;
    fn number(&self, column: usize) -> Self::Number;
    /// Loads columns `column`, `column + 1` and `column + 2`.
    fn vector(&self, column: usize) -> Self::Vector;
}

/// How packets load and store a field of this type.
pub trait Shape<R> {
    /// The field's type in a packet.
    type Of<C: Columns<R>>;
    /// Loads the field that starts at column `first`.
    fn load<C: Columns<R>>(columns: &C, first: usize) -> Self::Of<C>;
    /// Stores the field from column `first` on.
    fn store(self, columns: &mut [R], first: usize);
}

impl<R: Real> Shape<R> for R {
    type Of<C: Columns<R>> = C::Number;
    #[inline(always)]
    fn load<C: Columns<R>>(columns: &C, first: usize) -> C::Number {
        columns.number(first)
    }
    fn store(self, columns: &mut [R], first: usize) {
        columns[first] = self;
    }
}

impl<R: Real> Shape<R> for [R; 3] {
    type Of<C: Columns<R>> = C::Vector;
    #[inline(always)]
    fn load<C: Columns<R>>(columns: &C, first: usize) -> C::Vector {
        columns.vector(first)
    }
    fn store(self, columns: &mut [R], first: usize) {
        columns[first..first + 3].copy_from_slice(&self);
    }
}

/// Declares a [`Record`]: an ordinary struct with its name in WGSL. A struct with a type parameter holds numbers of
/// either precision, and shaders read the `f32` version. `as` after a field's type gives the type another name in WGSL.
/// With `loaded by`, packets can load the fields by name.
macro_rules! record {
    (
        $(#[$meta:meta])*
        pub struct $name:ident<$real:ident> as $wgsl:literal, loaded by $loads:ident { $($fields:tt)* }
    ) => {
        record! { $(#[$meta])* pub struct $name<$real> as $wgsl { $($fields)* } }
        loads! { $name<$real> by $loads { $($fields)* } }
    };
    (
        $(#[$meta:meta])*
        pub struct $name:ident $(<$real:ident>)? as $wgsl:literal {
            $($(#[doc = $doc:literal])* pub $field:ident: $type:ty $(as $other:literal)?,)*
        }
    ) => {
        $(#[$meta])*
        #[repr(C)]
        pub struct $name $(<$real>)? {
            $($(#[doc = $doc])* pub $field: $type,)*
        }

        impl Shared for $name $(<single!($real)>)? {
            fn wgsl() -> String {
                $wgsl.to_owned()
            }
            fn write(&self, words: &mut Vec<u32>) {
                $(self.$field.write(words);)*
            }
        }

        impl Record for $name $(<single!($real)>)? {
            fn fields() -> Vec<Field> {
                $(type $real = f32;)?
                vec![$(Field {
                    name: stringify!($field),
                    wgsl: last!(<$type as Shared>::wgsl() $(, $other.to_owned())?),
                    offset: std::mem::offset_of!(Self, $field),
                }),*]
            }
        }
    };
}

/// Replaces the precision parameter, whatever its name, by the shaders' precision.
macro_rules! single {
    ($real:ident) => {
        f32
    };
}

/// Selects the last of one or two values.
macro_rules! last {
    ($value:expr) => {
        $value
    };
    ($value:expr, $other:expr) => {
        $other
    };
}

/// Declares a trait through which packets load a record's fields by name.
macro_rules! loads {
    (
        $name:ident<$real:ident> by $loads:ident {
            $($(#[doc = $doc:literal])* pub $field:ident: $type:ty,)*
        }
    ) => {
        #[doc = concat!("The fields of a [`", stringify!($name), "`] a lane.")]
        pub trait $loads<$real: Real>: Columns<$real> {
            $(
                $(#[doc = $doc])*
                #[inline(always)]
                fn $field(&self) -> <$type as Shape<$real>>::Of<Self> {
                    <$type as Shape<$real>>::load(self, column_of!($name, $field))
                }
            )*
        }

        impl<$real: Real, C: Columns<$real>> $loads<$real> for C {}

        impl<$real: Real> $name<$real> {
            /// Stores all numbers in order at the start of `columns`.
            pub fn store(self, columns: &mut [$real]) {
                $(<$type as Shape<$real>>::store(self.$field, columns, column_of!($name, $field));)*
            }
        }
    };
}

/// The first column of a field.
macro_rules! column_of {
    ($name:ident, $field:ident) => {
        const { std::mem::offset_of!($name<f32>, $field) / size_of::<f32>() }
    };
}

pub(super) use {column_of, last, loads, record, single};
