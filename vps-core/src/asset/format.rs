//! The `.vps` file: an [`Asset`] as bytes that are used in place.
//!
//! All numbers are little-endian, as the target must be. A header of 64 bytes is followed by
//! sections, each starting at a multiple of 64 bytes, zeros between them:
//!
//! | bytes | what |
//! |---|---|
//! | 0..8 | the characters `VPSASSET` |
//! | 8..16 | version, [`VPS_VERSION`] |
//! | 16..24 | XXH3-64 of all bytes from 24 on |
//! | 24..32 | number of values of the voxelmap |
//! | 32..40 | number of points |
//! | 40..48 | number of clusters |
//! | 48..52 | number of groups of cells, 0 for a dense voxelmap |
//! | 52..56 | number of refined cells |
//! | 56..60 | number of curvature bounds |
//! | 60..62 | bytes of a value: 2 (i16) or 4 (f32) |
//! | 62..64 | number of levels + 1 |
//!
//! Sections in order:
//!
//! | section | an element | bytes |
//! |---|---|---|
//! | parameters | see below | 136 |
//! | values v of the voxelmap, in the order of its [`Store`] | i16 or f32 | 2 or 4 |
//! | curvature bounds, one for each cell of 8 x 8 x 8 voxels (see [`VoxelmapParts`]) | u8 | 1 |
//! | groups of cells | a [`CellGroup`]: two times bits u64, rank u32, zero u32 | 24 |
//! | refined cells | a [`RefinedCell`]: bits u64, first brick u32, zero u32 | 16 |
//! | points in metres, in the order of the leaves | 3 x f32 | 12 |
//! | unit inward normals | 3 x f32 | 12 |
//! | areas of the points in m² | f32 | 4 |
//! | clusters, level by level from the top | a [`Cluster`]: centre, radius, normal, half thickness, apex, half curvature, first child, number of children, parent point (u32 each, the others f32), area | 56 |
//! | level starts | u32 | 4 |
//!
//! The parameters, in metres where they have a unit:
//!
//! | bytes | what |
//! |---|---|
//! | 0..24 | origin of the asset's frame in the coordinates of the mesh (f64) |
//! | 24..36 | voxels along x, y, z (u32) |
//! | 36..48 | lowest corner of the grid (f32, as all that follow) |
//! | 48..52 | voxel size s |
//! | 52..56 | σ, metres per step of a value |
//! | 56..80 | lowest and highest corner of the box of the mesh |
//! | 80..92 | largest error in the narrow band, largest error beyond it, half width of the band (see [`ErrorBounds`]) |
//! | 92..132 | [`MassProperties`]: volume, centre, inertia xx, yy, zz, xy, xz, yz |
//! | 132..136 | zeros |

use bytemuck::{Pod, Zeroable};
use glamx::Vec3;
use xxhash_rust::xxh3::xxh3_64;

use super::Asset;
use super::mass::MassProperties;
use crate::aabb::Aabb;
use crate::map::store::{CellGroup, RefinedCell, Store, Values};
use crate::map::{ErrorBounds, Grid, GridError, Voxelmap, VoxelmapError, VoxelmapParts};
use crate::shell::{Cluster, PointSphereTree, TreeError, TreeParts};

/// Version of the `.vps` file this library reads and writes.
pub const VPS_VERSION: u64 = 5;

const MAGIC: [u8; 8] = *b"VPSASSET";
/// Sections start at a multiple of this.
const SECTION_ALIGN: usize = 64;
/// The address of the bytes must be a multiple of this.
const ADDRESS_ALIGN: usize = 8;

/// The first 64 bytes.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Header {
    magic: [u8; 8],
    version: u64,
    checksum: u64,
    values: u64,
    points: u64,
    clusters: u64,
    groups: u32,
    cells: u32,
    curvature_bounds: u32,
    value_bytes: u16,
    level_starts: u16,
}

/// Start of the bytes that the checksum covers.
const CHECKSUM_START: usize = 24;

/// The part of an asset that has a fixed size.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Parameters {
    origin: [f64; 3],
    dims: [u32; 3],
    grid_origin: [f32; 3],
    voxel_size: f32,
    sigma: f32,
    solid_min: [f32; 3],
    solid_max: [f32; 3],
    in_band: f32,
    beyond: f32,
    narrow_band: f32,
    mass: MassProperties,
    zero: u32,
}

/// Why bytes are not an [`Asset`].
///
/// ```
/// use vps_core::{Aligned, Asset, FormatError};
///
/// let foreign = Aligned([0; 64]);
/// assert_eq!(Asset::from_bytes(&foreign.0).unwrap_err(), FormatError::Foreign);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file is of another kind.
    #[error("not a .vps file")]
    Foreign,
    /// The file is of another version of the format.
    #[error("a .vps file of version {0}, but this library reads {VPS_VERSION}: build it again")]
    Version(u64),
    /// The file is shorter or longer than its header states.
    #[error("the file has {found} bytes, but its header declares {expected}")]
    Length {
        /// Bytes the header asks for.
        expected: u64,
        /// Bytes there are.
        found: u64,
    },
    /// The bytes are damaged.
    #[error("the checksum does not match: the file is damaged")]
    Checksum,
    /// The bytes do not start at a multiple of 8.
    #[error(
        "the bytes must lie at an address that is a multiple of 8: `vps_core::include_asset!` \
         puts those of a file there, `vps_core::Aligned` is a buffer there"
    )]
    Alignment,
    /// The size of values is invalid.
    #[error("in the voxelmap: values of {0} bytes")]
    ValueBytes(u16),
    /// The origin of the asset is not finite.
    #[error("the origin of the asset is not finite: {0:?}")]
    Origin([f64; 3]),
    /// The grid is invalid.
    #[error("in the voxelmap: {0}")]
    Grid(#[from] GridError),
    /// The voxelmap is invalid.
    #[error("in the voxelmap: {0}")]
    Voxelmap(#[from] VoxelmapError),
    /// The tree is invalid.
    #[error("in the point-sphere tree: {0}")]
    Tree(#[from] TreeError),
}

/// The positions of the sections of a file.
struct SectionLayout {
    starts: [usize; 10],
    end: usize,
}

impl SectionLayout {
    /// `None` if the sizes exceed the address space.
    fn of(header: &Header) -> Option<Self> {
        let size = |count: u64, of: usize| {
            let count = usize::try_from(count).ok()?;
            count.checked_mul(of)
        };
        let sizes = [
            size_of::<Parameters>(),
            size(header.values, header.value_bytes as usize)?,
            header.curvature_bounds as usize,
            size(u64::from(header.groups), size_of::<CellGroup>())?,
            size(u64::from(header.cells), size_of::<RefinedCell>())?,
            size(header.points, size_of::<[f32; 3]>())?,
            size(header.points, size_of::<[f32; 3]>())?,
            size(header.points, size_of::<f32>())?,
            size(header.clusters, size_of::<Cluster>())?,
            size(u64::from(header.level_starts), size_of::<u32>())?,
        ];
        let mut starts = [0; 10];
        let mut end = size_of::<Header>();
        for (start, size) in starts.iter_mut().zip(sizes) {
            *start = end.checked_next_multiple_of(SECTION_ALIGN)?;
            end = start.checked_add(size)?;
        }
        Some(Self { starts, end })
    }
}

impl<'a> Asset<'a> {
    /// Reads the bytes of a `.vps` file in place: nothing is copied.
    ///
    /// Their address must be a multiple of 8. [`include_asset!`](crate::include_asset) aligns the
    /// bytes of a file, which `include_bytes!` does not; [`Aligned`](crate::Aligned) is an aligned
    /// buffer. Costs one pass over the bytes for the checksum and one over the points for each
    /// level of the tree.
    ///
    /// # Errors
    /// When the bytes are not a valid asset of this version, or not aligned.
    pub fn from_bytes(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let start = bytes
            .get(..size_of::<Header>())
            .ok_or(FormatError::Foreign)?;
        let header: Header = bytemuck::pod_read_unaligned(start);
        if header.magic != MAGIC {
            return Err(FormatError::Foreign);
        }
        if header.version != VPS_VERSION {
            return Err(FormatError::Version(header.version));
        }
        // Independent of the contents, so that a wrong alignment fails with every file.
        if !bytes.as_ptr().addr().is_multiple_of(ADDRESS_ALIGN) {
            return Err(FormatError::Alignment);
        }
        let wrong_length = |expected: usize| FormatError::Length {
            expected: expected as u64,
            found: bytes.len() as u64,
        };
        let layout = SectionLayout::of(&header).ok_or(wrong_length(usize::MAX))?;
        if bytes.len() != layout.end {
            return Err(wrong_length(layout.end));
        }
        if xxh3_64(&bytes[CHECKSUM_START..]) != header.checksum {
            return Err(FormatError::Checksum);
        }
        fn cast<T: Pod>(bytes: &[u8], start: usize, count: usize) -> Result<&[T], FormatError> {
            bytemuck::try_cast_slice(&bytes[start..start + count * size_of::<T>()])
                .map_err(|_| FormatError::Alignment)
        }
        let [
            parameters,
            values,
            curvature_bounds,
            groups,
            cells,
            points,
            normals,
            areas,
            clusters,
            levels,
        ] = layout.starts;
        let parameters: &[Parameters] = cast(bytes, parameters, 1)?;
        let p = parameters[0];
        let point_count = header.points as usize;
        let count = header.values as usize;
        let values = match header.value_bytes {
            2 => Values::Integers(cast(bytes, values, count)?.into()),
            4 => Values::Floats(cast(bytes, values, count)?.into()),
            other => return Err(FormatError::ValueBytes(other)),
        };
        let store = if header.groups == 0 {
            Store::dense(p.dims, values)?
        } else {
            let groups = cast(bytes, groups, header.groups as usize)?.into();
            let cells = cast(bytes, cells, header.cells as usize)?.into();
            Store::sparse(p.dims, groups, cells, values)?
        };
        if !p.origin.iter().all(|c| c.is_finite()) {
            return Err(FormatError::Origin(p.origin));
        }
        Ok(Self {
            origin: p.origin,
            voxelmap: Voxelmap::from_parts(VoxelmapParts {
                grid: Grid::new(Vec3::from_array(p.grid_origin), p.voxel_size, p.dims)?,
                sigma: p.sigma,
                solid: Aabb {
                    min: Vec3::from_array(p.solid_min),
                    max: Vec3::from_array(p.solid_max),
                },
                error_bounds: ErrorBounds {
                    in_band: p.in_band,
                    beyond: p.beyond,
                    narrow_band: p.narrow_band,
                },
                store,
                curvature_bounds: cast(bytes, curvature_bounds, header.curvature_bounds as usize)?
                    .into(),
            })?,
            tree: PointSphereTree::from_parts(TreeParts {
                points: cast(bytes, points, point_count)?.into(),
                normals: cast(bytes, normals, point_count)?.into(),
                areas: cast(bytes, areas, point_count)?.into(),
                clusters: cast(bytes, clusters, header.clusters as usize)?.into(),
                level_starts: cast(bytes, levels, header.level_starts as usize)?.into(),
            })?,
            mass: p.mass,
        })
    }
}

#[cfg(feature = "alloc")]
impl Asset<'_> {
    /// The bytes of the `.vps` file of this asset, for [`from_bytes`](Self::from_bytes).
    pub fn to_bytes(&self) -> alloc::vec::Vec<u8> {
        use bytemuck::{bytes_of, cast_slice};

        let (map, tree) = (&self.voxelmap, &self.tree);
        let values = map.store().values();
        let (groups, cells) = map.store().cells();
        let mut header = Header {
            magic: MAGIC,
            version: VPS_VERSION,
            checksum: 0,
            values: values.len() as u64,
            points: tree.point_count() as u64,
            clusters: tree.clusters().len() as u64,
            groups: groups.len() as u32,
            cells: cells.len() as u32,
            curvature_bounds: map.curvature_bounds().len() as u32,
            value_bytes: match values {
                Values::Integers(_) => 2,
                Values::Floats(_) => 4,
            },
            level_starts: tree.level_starts().len() as u16,
        };
        let error_bounds = map.error_bounds();
        let parameters = Parameters {
            origin: self.origin,
            dims: map.grid().dims(),
            grid_origin: map.grid().origin().to_array(),
            voxel_size: map.grid().voxel_size(),
            sigma: map.sigma(),
            solid_min: map.solid().min.to_array(),
            solid_max: map.solid().max.to_array(),
            in_band: error_bounds.in_band,
            beyond: error_bounds.beyond,
            narrow_band: error_bounds.narrow_band,
            mass: self.mass,
            zero: 0,
        };
        let sections: [&[u8]; 10] = [
            bytes_of(&parameters),
            values.bytes(),
            map.curvature_bounds(),
            cast_slice(groups),
            cast_slice(cells),
            cast_slice(tree.points()),
            cast_slice(tree.normals()),
            cast_slice(tree.areas()),
            cast_slice(tree.clusters()),
            cast_slice(tree.level_starts()),
        ];
        let mut bytes = alloc::vec![0; size_of::<Header>()];
        for section in sections {
            bytes.resize(bytes.len().next_multiple_of(SECTION_ALIGN), 0);
            bytes.extend_from_slice(section);
        }
        bytes[..size_of::<Header>()].copy_from_slice(bytes_of(&header));
        header.checksum = xxh3_64(&bytes[CHECKSUM_START..]);
        bytes[..size_of::<Header>()].copy_from_slice(bytes_of(&header));
        bytes
    }
}
