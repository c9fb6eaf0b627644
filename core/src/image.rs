//! Pictures in memory, one plane of numbers for each quantity.

/// A rectangle of texels, row by row from the upper left corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plane<T = f32> {
    width: u32,
    height: u32,
    texels: Vec<T>,
}

impl<T: Copy> Plane<T> {
    /// A plane of `width` x `height` texels of one value.
    pub fn filled(width: u32, height: u32, value: T) -> Self {
        Self { width, height, texels: vec![value; width as usize * height as usize] }
    }

    /// A plane whose texel at (x, y) is `value(x, y)`.
    pub fn from_fn(width: u32, height: u32, mut value: impl FnMut(u32, u32) -> T) -> Self {
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y));
        Self { width, height, texels: texels.collect() }
    }

    /// Takes another size; the texels are anything after that. Memory is only asked for beyond the largest size so far.
    pub fn resize(&mut self, width: u32, height: u32)
    where
        T: Default,
    {
        (self.width, self.height) = (width, height);
        self.texels.resize(width as usize * height as usize, T::default());
    }

    /// Columns, texels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows, texels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All texels, row by row.
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// All texels, row by row, to write to.
    pub fn texels_mut(&mut self) -> &mut [T] {
        &mut self.texels
    }

    /// Row `y`, below [`Self::height`].
    pub fn row(&self, y: u32) -> &[T] {
        let start = y as usize * self.width as usize;
        &self.texels[start..start + self.width as usize]
    }

    /// Row `y`, below [`Self::height`], to write to.
    pub fn row_mut(&mut self, y: u32) -> &mut [T] {
        let start = y as usize * self.width as usize;
        &mut self.texels[start..start + self.width as usize]
    }

    /// The texel at column `x`, row `y`, both within the plane.
    pub fn at(&self, x: u32, y: u32) -> T {
        self.row(y)[x as usize]
    }
}
