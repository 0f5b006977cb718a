//! The Python package `cylindroid`: the library for numpy, without mathematics of its own.
//!
//! Numbers come in without a copy where the layout allows it, results are one allocation. The
//! interpreter is free during batches, searches and reports; single steps of a few microseconds
//! keep it, since to get it back from another thread can take milliseconds. Errors of the library
//! become exceptions, one class for each kind. The documentation of every function is that of the
//! Python user.

mod arrays;
mod arrow;
mod closed;
mod collision;
mod columns;
mod command_line;
mod control;
mod coordinates;
mod error;
mod ik;
mod inverse;
mod mechanism;
mod motion;
mod optimise;
mod options;
mod parameter_tables;
mod screws;
mod servo;
mod spatial;
mod sweep;
mod table;
mod tasks;
mod threads;
mod view;
mod workspace_map;
mod zone;

use pyo3::prelude::*;

/// The compiled part of `cylindroid`.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::closed::{
        PyActuatorTransmission, PyAssembly, PyAssemblyModes, PyBranch, PyConstraint,
        PyContactForces, PyContinuationResult, PyDeflection, PyDirection, PyEllipsoid,
        PyFingerContact, PyFiniteMobility, PyGradient, PyGraspMobility, PyGraspQuality,
        PyJointMobility, PyJointTorques, PyLimb, PyLoopClosureError, PyManipulability, PyMobility,
        PyModeMeeting, PyOperationMode, PyOperationModes, PyPolytope, PySingularity, PySpectrum,
        PyStiffness, PyTransmission, PyTransmittedWrench, grasp::grasp_quality,
        grasp_mobility::grasp_mobility,
    };
    #[pymodule_export]
    use crate::collision::{PyCollisionModel, PyDistances};
    #[pymodule_export]
    use crate::columns::PyColumns;
    #[pymodule_export]
    use crate::command_line::run_command_line;
    #[pymodule_export]
    use crate::control::{
        PyAdmittance, PyHybridCommand, PyHybridController, PyInternalForceCommand,
        PyInternalForceController, PyOperatorAuthority, PySharedCommand, PySharedController,
    };
    #[pymodule_export]
    use crate::ik::PySolution;
    #[pymodule_export]
    use crate::inverse::by_name::inverse_by_name;
    #[pymodule_export]
    use crate::inverse::damped::{damped, selectively_damped};
    #[pymodule_export]
    use crate::inverse::hyperbolic::{hyperbolic, oblique};
    #[pymodule_export]
    use crate::inverse::hyperbolic_svd::{PyHyperbolicSvd, hyperbolic_svd};
    #[pymodule_export]
    use crate::inverse::pinv::pinv;
    #[pymodule_export]
    use crate::inverse::point_direction::point_direction;
    #[pymodule_export]
    use crate::inverse::{PyInverse, PyPointDirection, PyTruncatedDirection};
    #[pymodule_export]
    use crate::mechanism::load::{catalogue, load, parse};
    #[pymodule_export]
    use crate::mechanism::{PyJoint, PyLoadReport, PyMechanism, PyParameter, PySrdf};
    #[pymodule_export]
    use crate::motion::{PyCartesianMove, PyCartesianPath, PyJointMove, PyTimeLaw, PyWaypointMove};
    #[pymodule_export]
    use crate::optimise::{PyOptimalDesigns, optimise};
    #[pymodule_export]
    use crate::parameter_tables::{inverse_methods, secondary_tasks};
    #[pymodule_export]
    use crate::screws::eigenscrews::eigenscrews;
    #[pymodule_export]
    use crate::screws::forms::{
        gram, gram_determinant, killing, klein, lowered, pitch_form, raised, wrench_pitch_form,
    };
    #[pymodule_export]
    use crate::screws::involution::involution;
    #[pymodule_export]
    use crate::screws::projector::{adjoint, projector, screw_to};
    #[pymodule_export]
    use crate::screws::transversals::transversals;
    #[pymodule_export]
    use crate::screws::{
        PyEigenscrews, PyErrorFormZeros, PyExistence, PyInvolution, PyMargin, PyPitchConics,
        PyProjector, PyScrew, PyScrewSystem, PyTransversals,
    };
    #[pymodule_export]
    use crate::servo::{PyMotionResult, PyServo, PyStall, PyTrajectory};
    #[pymodule_export]
    use crate::spatial::{
        bracket, coadjoint, error_to, exp, exp_derivative, log, log_derivative,
        rotation_exp_derivative, rotation_log_derivative, velocity_conversion,
    };
    #[pymodule_export]
    use crate::sweep::{PySweepFolder, PySweepPlan, PySweepSummary};
    #[pymodule_export]
    use crate::tasks::{
        PyCenterOfMassTask, PyCollisionAvoidance, PyCustomTask, PyFrameTask, PyGazeTask,
        PyHalfSpace, PyJointVelocitiesTask, PyLimitAvoidanceTask, PyManipulabilityTask,
        PyMotionTask, PyPostureTask, PyRelativeFrameTask, PyTaskReport, PyTaskServo,
    };
    #[pymodule_export]
    use crate::view::PyView;
    #[pymodule_export]
    use crate::view::start::{close_views, has_page, start_view};
    #[pymodule_export]
    use crate::workspace_map::{PyWorkspaceMap, workspace_map};
    #[pymodule_export]
    use crate::zone::{PyZone, singularity_free_zone};

    use super::*;

    #[pymodule_init]
    fn init(m: &Bound<'_, PyModule>) -> PyResult<()> {
        m.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
