//! The scene of each frame of an animation.

use crate::{
    figure::scene_file,
    scene::{
        Scene,
        animation::{Animation, Track},
    },
    view::{default_near_m, path::CameraPath},
};

/// An animation, ready to be asked for its frames.
#[derive(Clone, Debug)]
pub struct Film {
    /// The scene without its animation.
    still: Scene,
    animation: Animation,
    camera: Option<CameraPath>,
    tracks: Vec<(String, Track)>,
}

/// Why a frame has no scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// Nothing changes.
    #[error("[animation] is missing: camera = [{{ at = 0.0, eye = ..., target = ... }}, ...] in it would be right")]
    NoAnimation,
    /// The camera has no path.
    #[error("[animation] camera: {0}")]
    Camera(String),
    /// Keys of several forms.
    #[error("[animation] change.{0} keys: the values have several forms")]
    Forms(usize),
    /// A moment that is no scene.
    #[error("[animation] frame {frame}, at {time:.3} s: {message}")]
    Frame {
        /// Its number, from 0.
        frame: u32,
        /// Seconds.
        time: f64,
        /// What is wrong.
        message: String,
    },
}

impl Film {
    /// Of a scene with an animation.
    pub fn new(scene: &Scene) -> Result<Self, FilmError> {
        let mut still = scene.clone();
        let animation = still.animation.take().ok_or(FilmError::NoAnimation)?;
        // A near plane of its own stays; the default follows the target.
        let near_m = scene
            .camera
            .filter(|camera| camera.near_m != default_near_m(camera.eye.distance(camera.target)))
            .map(|camera| camera.near_m);
        let camera = animation.camera_path(near_m).transpose().map_err(|e| FilmError::Camera(e.to_string()))?;
        let track = |(i, change): (usize, &_)| Track::new(change).ok_or(FilmError::Forms(i));
        let tracks: Vec<Track> = animation.changes.iter().enumerate().map(track).collect::<Result<_, _>>()?;
        let tracks = animation.changes.iter().map(|change| change.path.clone()).zip(tracks).collect();
        Ok(Self { still, animation, camera, tracks })
    }

    /// How many frames it has.
    pub fn frames(&self) -> u32 {
        self.animation.frames
    }

    /// Pictures per second.
    pub fn fps(&self) -> f64 {
        self.animation.fps
    }

    /// The scene of a frame, from 0: what `--set` with the values of its moment makes of the still one.
    pub fn scene(&self, frame: u32) -> Result<Scene, FilmError> {
        let time = self.animation.time(frame);
        let failed = |message| FilmError::Frame { frame, time, message };
        let mut scene = self.still.clone();
        scene.time_s += time;
        scene.moment = self.animation.moment(frame).or(scene.moment);
        if let Some(path) = &self.camera {
            scene.camera = Some(path.at(time).map_err(|error| failed(format!("camera: {error}")))?);
        }
        for (path, track) in &self.tracks {
            let assignment = format!("{path}={}", track.at(time));
            let command = scene_file::set(&scene, &assignment).map_err(|error| failed(error.to_string()))?;
            command.redo(&mut scene);
        }
        Ok(scene)
    }
}
