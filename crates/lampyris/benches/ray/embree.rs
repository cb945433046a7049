//! Embree 4 as a yardstick, by the few functions that it takes, from a library that is opened at run time.

#![allow(unsafe_code)]

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::mem::ManuallyDrop;
use std::ptr;
use std::rc::Rc;

use lampyris::geometry::{MeshData, Ray};
use libloading::Symbol;

/// The functions, as `embree4/rtcore.h` declares them. Handles are pointers that nobody looks behind.
type Handle = *mut c_void;
type NewDevice = unsafe extern "C" fn(*const c_char) -> Handle;
type NewScene = unsafe extern "C" fn(Handle) -> Handle;
type NewGeometry = unsafe extern "C" fn(Handle, c_int) -> Handle;
type SetNewBuffer = unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
type Attach = unsafe extern "C" fn(Handle, Handle) -> c_uint;
type Commit = unsafe extern "C" fn(Handle);
type Intersect = unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void);
type Occluded = unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void);

const TRIANGLES: c_int = 0;
const INDICES: c_int = 0;
const VERTICES: c_int = 1;
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;

#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    uv: [f32; 2],
    triangle: u32,
    geometry: u32,
    /// Instance numbers, and room for those of other builds of the library.
    instances: [u32; 9],
}

/// It stays open to the end, since its threads do.
#[derive(Clone)]
pub struct Library(Rc<ManuallyDrop<libloading::Library>>);

pub struct Scene {
    scene: Handle,
    intersect: Intersect,
    occluded: Occluded,
    _library: Library,
}

impl Library {
    pub fn open(path: &str) -> Result<Library, libloading::Error> {
        // SAFETY: whoever names the library trusts what it does when it is opened.
        Ok(Library(Rc::new(ManuallyDrop::new(unsafe { libloading::Library::new(path) }?))))
    }

    fn symbol<T>(&self, name: &str) -> Symbol<'_, T> {
        // SAFETY: the types are those of the library's header.
        unsafe { self.0.get(name.as_bytes()) }.expect("a function of Embree 4")
    }

    /// A scene of one mesh, built in the library's own default way.
    pub fn scene(&self, mesh: &MeshData) -> Scene {
        let commit_geometry: Symbol<Commit> = self.symbol("rtcCommitGeometry");
        let commit_scene: Symbol<Commit> = self.symbol("rtcCommitScene");
        // SAFETY: the calls and their order are those of the library's manual; the buffers have the sizes asked for.
        let scene = unsafe {
            let device = self.symbol::<NewDevice>("rtcNewDevice")(ptr::null());
            let scene = self.symbol::<NewScene>("rtcNewScene")(device);
            let geometry = self.symbol::<NewGeometry>("rtcNewGeometry")(device, TRIANGLES);
            let new_buffer = self.symbol::<SetNewBuffer>("rtcSetNewGeometryBuffer");
            let vertices = new_buffer(geometry, VERTICES, 0, FLOAT3, 12, mesh.positions.len());
            ptr::copy_nonoverlapping(mesh.positions.as_ptr(), vertices.cast(), mesh.positions.len());
            let indices = new_buffer(geometry, INDICES, 0, UINT3, 12, mesh.triangles.len());
            ptr::copy_nonoverlapping(mesh.triangles.as_ptr(), indices.cast(), mesh.triangles.len());
            commit_geometry(geometry);
            self.symbol::<Attach>("rtcAttachGeometry")(scene, geometry);
            commit_scene(scene);
            scene
        };
        let (intersect, occluded) = (*self.symbol("rtcIntersect1"), *self.symbol("rtcOccluded1"));
        Scene { scene, intersect, occluded, _library: self.clone() }
    }
}

impl RayHit {
    #[inline]
    fn new(ray: &Ray, max: f32) -> RayHit {
        RayHit {
            origin: ray.origin.to_array(),
            near: 0.0,
            direction: ray.direction.to_array(),
            time: 0.0,
            far: max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            uv: [0.0; 2],
            triangle: u32::MAX,
            geometry: u32::MAX,
            instances: [u32::MAX; 9],
        }
    }
}

impl super::Tracer for Scene {
    fn name(&self) -> &'static str {
        "embree"
    }

    fn closest(&self, ray: &Ray) -> Option<f32> {
        let mut hit = RayHit::new(ray, f32::INFINITY);
        // SAFETY: the scene is committed, and the ray has the layout and alignment of the library's.
        unsafe { (self.intersect)(self.scene, &mut hit, ptr::null_mut()) };
        (hit.geometry != u32::MAX).then_some(hit.far)
    }

    fn blocked(&self, ray: &Ray, max: f32) -> bool {
        let mut hit = RayHit::new(ray, max);
        // SAFETY: as above; the function reads and writes the first part, the ray, alone.
        unsafe { (self.occluded)(self.scene, &mut hit, ptr::null_mut()) };
        hit.far < 0.0
    }
}
