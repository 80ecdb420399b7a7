// Written by generate.py from api.json; not by hand.

package tribo

import "unsafe"

// Constants of the C library, by their names without TRIBO_.
const (
	World     uint32 = 4294967295
	MaxPoints uint32 = 4
	MaxFace   uint32 = 32
	// sqrt(a b): Box2D, Box3D and Jolt for friction
	MixGeometricMean uint32 = 0
	// min(a, b)
	MixMinimum uint32 = 1
	// max(a, b): Box2D, Box3D and Jolt for restitution
	MixMaximum uint32 = 2
	// a b: Bullet
	MixProduct uint32 = 3
	// (a + b) / 2: default of PhysX and of Rapier
	MixArithmeticMean uint32 = 4
	// separates, or no impulse is needed
	ModeOpen uint32 = 0
	// friction takes all sliding it is asked to, within mu_s p_n
	ModeStick uint32 = 1
	// the impulse lies on the friction cone of mu_d
	ModeSlip uint32 = 2
	// batch only: no bounded impulse exists
	ModeJam uint32 = 3
	// Chatterjee & Ruina, J. Appl. Mech. 65 (1998) 939: P = (1+e) P_I + kappa (P_II - P_I), P_I
	//  the frictionless plastic and P_II the sticking plastic impulse, kappa = 1 + e_t, or the
	//  greatest smaller value that keeps P in the friction cone. u_n+ = -e u_n-; the cone holds;
	//  and, because P_I and P_II - P_I are W-orthogonal, energy never grows:
	//  dT = -(1-e^2)/2 |P_I|^2_W - kappa (2 - kappa)/2 |P_II - P_I|^2_W. Closed form.
	LawAlgebraic uint32 = 0
	// p = -(1+e) u_n / W_nn along the normal (lecture, collision resolution, steps 1-5).
	LawFrictionless uint32 = 1
	// The lecture's velocity rule through the 3x3 system: u_n+ = -e u_n-; u_t+ = 0 if
	//  |u_t| <= mu_s v_c, else (1 - mu_d) u_t. Faithful to the slides; it may leave the friction
	//  cone or gain energy, which the audit shows.
	LawLecture uint32 = 2
	// Coulomb's law exactly (cone, and slip opposite to friction after the impact) with Newton's
	//  u_n+ = -e u_n-. May gain energy for e > 0 with friction: see energy in the info.
	LawCoulomb uint32 = 3
	// Routh's incremental law: Coulomb friction along the growing normal impulse (Keller,
	//  J. Appl. Mech. 53 (1986) 1), ended by Newton's hypothesis u_n+ = -e u_n-.
	LawRouthNewton uint32 = 4
	// ... ended by Poisson's: p_n = (1+e) p_n at greatest compression. Where slip that turns
	//  compresses the contact a second time, the last compression counts, for this law and the
	//  next.
	LawRouthPoisson uint32 = 5
	// ... ended by Stronge's (J. Appl. Mech. 58 (1991) 1049): the normal work regained in
	//  restitution is e^2 times that spent in compression.
	LawRouthStronge uint32 = 6
	// As LECTURE, but sliding loses what dynamic friction on the closing velocity v_c takes:
	//  u_t+ = u_t max(0, 1 - mu_d v_c / |u_t|), the rule before the slides' approximation.
	LawLectureClosing uint32 = 7
	// the best one that this machine has
	IsaBest uint32 = 0
	// one contact after the other by the functions of contact.h
	IsaScalar uint32 = 1
	// lanes with what every machine of this architecture has
	IsaBaseline uint32 = 2
	// AVX2
	IsaX8664V3 uint32 = 3
	// AVX-512
	IsaX8664V4 uint32 = 4
	// size = {radius}
	ShapeSphere uint32 = 1
	// size = {hx, hy, hz}, half-extents
	ShapeBox uint32 = 2
	// size = {radius, half_height}: all within r of z = -h to h
	ShapeCapsule uint32 = 3
	// size = {radius, half_height}, axis z
	ShapeCylinder uint32 = 4
	// size = {radius, half_height}: base at z = -h, apex at z = h
	ShapeCone uint32 = 5
	// size = {a, b, c}, semi-axes
	ShapeEllipsoid uint32 = 6
	// data: block of tribo_hull_build
	ShapeHull uint32 = 7
	// data: const tribo_convex *, the user's own support function
	ShapeConvex uint32 = 8
	// size = {nx, ny, nz, d}: n . x <= d, with |n| = 1 to 5e-13
	ShapeHalfspace uint32 = 9
	// data: block of tribo_mesh_build; static terrain
	ShapeMesh uint32 = 10
	// data: const tribo_child *, count children, each convex
	ShapeCompound uint32 = 11
	// closed form if there is one, else general
	MethodAutomatic uint32 = 0
	// closed form, or TRIBO_ERROR_OPTION if the pair has none
	MethodClosed uint32 = 1
	// by support functions alone; not for half-spaces
	MethodGeneral uint32 = 2
	// Gauss-Seidel first; then Newton, in turns with sweeps that Anderson's method accelerates
	//  (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715), for the components of the system that it
	//  does not finish.
	SolverAuto uint32 = 0
	// Sweeps of the exact solve of one contact after the other (Jourdan, Alart & Jean, Comput.
	//  Methods Appl. Mech. Eng. 155 (1998) 31).
	SolverGaussSeidel uint32 = 1
	// Proximal point and semismooth Newton, in the bodies' velocities or on W; and where that does
	//  not end soon, an interior-point method on the convex neighbour of the problem (Anitescu,
	//  Math. Program. 105 (2006) 113), which finds how a system can stand, whatever its size, and
	//  the central path of Coulomb's law itself, followed where it turns back, too. Where bodies
	//  slide over each other that path goes first.
	SolverNewton uint32 = 2
	// The greatest eta of the contacts: tribo_measures of audit.h, with all of W.
	MeasureEta uint32 = 0
	// sqrt(sum |s r - P_K(s r - u')|^2) / |q| over all contacts, s the mean diagonal entry of
	//  W.
	MeasureInvariant uint32 = 1
	// the tolerance is met
	StopTolerance uint32 = 0
	// max_iterations were done
	StopIterations uint32 = 1
	// max_seconds are over
	StopTime uint32 = 2
	// the progress callback asked for it
	StopCancel uint32 = 3
	// no solver makes progress any more
	StopStall uint32 = 4
	// no bounded impulses exist, or none that double can hold: the
	// least-bad ones found are returned
	StopJam uint32 = 5
	// the faster one, judged by operations for each number in the
	// factors
	SparseAuto uint32 = 0
	// CHOLMOD simplicial, KLU: best where factors stay thin
	SparseSimplicial uint32 = 1
	// CHOLMOD supernodal, UMFPACK: best where they fill up
	SparseSupernodal uint32 = 2
	// forces and contacts; it has a mass
	BodyDynamic uint32 = 0
	// its own velocities, which nothing changes
	BodyKinematic uint32 = 1
	// nothing; its velocities are zero
	BodyStatic uint32 = 2
	// start solvers from zero
	SkipWarmStart uint32 = 1
	// leave overlaps as they are
	SkipCorrection uint32 = 2
	// all impacts are plastic
	SkipRestitution uint32 = 4
	// contacts act once surfaces have met, not before
	SkipSpeculation uint32 = 8
	// touch in this step, and did not in the last
	EventBegin uint32 = 1
	// in both
	EventPersist uint32 = 2
	// in the last step alone
	EventEnd uint32 = 3
)

const (
	// a pointer that must not be null is null
	ErrNull Error = 10
	// struct_size is zero, odd or larger than this library knows
	ErrStructSize Error = 11
	// an enumerated option has no such value
	ErrOption Error = 12
	// an index lies outside of its array
	ErrIndex Error = 13
	// the instruction set is not available on this machine
	ErrIsa Error = 14
	// no entry has that name
	ErrName Error = 15
	// two arguments that must differ are the same object
	ErrAlias Error = 16
	// the caller's buffer is too small; the size needed is told
	ErrCapacity Error = 17
	// a library beneath could not allocate
	ErrMemory Error = 18
	// a block of data is not one that this library made
	ErrData Error = 19
	// an input is NaN or infinite
	ErrNotFinite Error = 20
	// a finite input or the result is outside of the stated
	// range
	ErrRange Error = 21
	// the contact normal is not of unit length
	ErrNormal Error = 22
	// the quaternion is not of unit length
	ErrOrientation Error = 23
	// the contact frame is not orthonormal and right-handed
	ErrFrame Error = 24
	// mass or inverse mass is negative, or zero where it must not
	// be
	ErrMass Error = 30
	// inertia is asymmetric, indefinite, or of no possible body
	ErrInertia Error = 31
	// a length or density of a shape is not positive
	ErrShape Error = 32
	// the time step is negative, or too long to be resolved
	ErrTimeStep Error = 33
	// points span no volume, or no triangle has an area
	ErrDegenerate Error = 34
	// a user's support function contradicts itself
	ErrSupport Error = 35
	// these two kinds of shapes cannot be tested against each other
	ErrPair Error = 36
	// mu_s < 0, mu_d < 0, mu_s < mu_d, or a length of rolling or
	// spinning resistance < 0
	ErrFriction Error = 40
	// e lies outside of [0, 1] (tangential: [-1, 1])
	ErrRestitution Error = 41
	// the contact matrix is not positive semidefinite
	ErrContactMatrix Error = 50
	// neither body can move at the contact along the normal
	ErrImmovable Error = 51
	// no bounded impulse satisfies Coulomb's law: the contact
	// jams
	ErrJam Error = 52
)

// Body is tribo_body of body.h.
// A rigid body. All zeros but orientation[0] = 1 is an immovable body at the origin.
//
//	160 bytes; layout is part of the ABI.
type Body struct {
	// centre of mass, world axes, m
	Position [3]float64
	// body to world; unit to 1e-6, used as if normalised
	Orientation [4]float64
	// of the centre of mass, world axes, m/s
	Velocity [3]float64
	// world axes, rad/s
	AngularVelocity [3]float64
	// 1/kg; 0: cannot be moved
	InverseMass float64
	// about the centre of mass, BODY axes, 1/(kg m^2), symmetric,
	// positive semidefinite; a zero row is an axis that cannot be
	// turned
	InverseInertia [6]float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(Body{})-160]

// Material is tribo_material of material.h.
// Coefficients of one material, or of a pair in contact; all without unit. 24 bytes.
type Material struct {
	// static friction, 0 <= mu_d <= mu_s < infinity: sticking holds up to mu_s
	// p_n
	MuS float64
	// dynamic friction: sliding friction is mu_d p_n
	MuD float64
	// restitution, 0 (plastic) to 1 (elastic)
	E float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(Material{})-24]

// Contact is tribo_contact of contact.h.
// Geometry of one contact. Arms instead of a point keep it exact far from the origin. 72 bytes.
type Contact struct {
	// unit to 1e-12, world axes, from B to A
	Normal [3]float64
	// contact point minus centre of mass of A, world axes, m
	ArmA [3]float64
	// contact point minus centre of mass of B, world axes, m
	ArmB [3]float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(Contact{})-72]

// ImpactInfo is tribo_impact_info of contact.h.
// What an impact did. The caller sets struct_size; a smaller (older) struct is filled as far as it
//
//	goes.
type ImpactInfo struct {
	structSize uint32
	// TRIBO_MODE_... at the end of the impact
	Mode uint32
	// root-finding or integration steps; 0 for closed forms
	Iterations uint32
	reserved   uint32
	// u+ in contact coordinates, m/s
	Velocity [3]float64
	// change of kinetic energy, p . (u- + u+) / 2, J
	Energy float64
	// ALGEBRAIC: the kappa used; other laws: 0
	Kappa float64
	// ROUTH: normal impulse at greatest compression, N s; other laws: 0
	Compression float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(ImpactInfo{})-64]

// SolveInfo is tribo_solve_info of contact.h.
// What the exact solve did; struct_size as above.
type SolveInfo struct {
	structSize uint32
	// OPEN, STICK or SLIP
	Mode uint32
	// Newton and bisection steps on the slip equation
	Iterations uint32
	reserved   uint32
	// slip: u_t = -nu p_t, 1/kg, DBL_MAX if beyond double; else 0
	Nu float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(SolveInfo{})-24]

// CollisionInfo is tribo_collision_info of contact.h.
// A whole collision; struct_size as above.
type CollisionInfo struct {
	structSize uint32
	// TRIBO_MODE_...
	Mode uint32
	// as in tribo_impact_info
	Iterations uint32
	reserved   uint32
	// rows n, t1, t2: world to contact coordinates
	Frame [9]float64
	// W, 1/kg
	Matrix [6]float64
	// u-, contact coordinates, m/s
	VelocityBefore [3]float64
	// u+ = u- + W p
	VelocityAfter [3]float64
	// p, contact coordinates, N s
	Impulse [3]float64
	// the same in world axes; acts on A, its negative on B
	ImpulseWorld [3]float64
	// change of kinetic energy, p . (u- + u+) / 2, J
	Energy float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(CollisionInfo{})-240]

// Totals is tribo_totals of audit.h.
// Totals over bodies. Bodies with zero inverse mass have no finite momentum and are left out. 80
//
//	bytes.
type Totals struct {
	// sum m v, kg m/s
	Linear [3]float64
	// sum (x - origin) x m v + I omega about one common point, kg m^2/s
	Angular [3]float64
	// sum m |v|^2 / 2 + omega . I omega / 2, J
	Energy float64
	// sum m, kg
	Mass float64
	// sum m |v|: what |linear| is measured against
	LinearScale float64
	// sum |x - origin| m |v| + |I omega|
	AngularScale float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(Totals{})-80]

// Measures is tribo_measures of audit.h.
// Measures of an impulse p for the problem v = W p + b with coefficient mu. Scales: V = |b| + the
//
//	norm of |W||p| (entrywise absolute values), P = V / greatest W_ii.
type Measures struct {
	// natural map |p - P_K(p - rho (v + mu |v_t| e_n))| / P,
	// rho = 1 / (greatest W_ii max(1, mu)): 0 at, and only at, a solution
	Eta float64
	// |min(v_n / V, p_n / P)|
	Signorini float64
	// max(0, |p_t| - mu p_n) / P
	Cone float64
	// | |v_t| p_t + mu p_n v_t | / (P V): friction not opposite to slip
	Misalignment float64
	// p . (b + v) / 2 / (P V): change of energy, signed, b the velocity
	// before (e = 0)
	Energy float64
	// v_n, m/s: the separating velocity
	Velocity float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(Measures{})-48]

// Pose is tribo_pose of shape.h.
// Position and orientation: body axes to world axes, as in tribo_body. 56 bytes.
type Pose struct {
	// m
	Position [3]float64
	// (w, x, y, z), unit to 1e-6, used as if normalised
	Orientation [4]float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(Pose{})-56]

// Point is tribo_point of collide.h.
// One point of a manifold. 64 bytes.
type Point struct {
	// from A's position to the point, midway between the surfaces, m
	ArmA [3]float64
	// the same point from the position of B's pose, m
	ArmB [3]float64
	// of the surfaces along the normal, m; negative inside
	Distance float64
	// which features touch, A's in the high half, B's in the low: persists from
	// step to step while they do. A corner within 1e-4 of the shortest side from
	// a vertex or edge has its name, so stacks of equal boxes keep theirs
	Id uint64
}

var _ = [1]struct{}{}[unsafe.Sizeof(Point{})-64]

// Manifold is tribo_manifold of collide.h.
// Contact between two convex parts.
type Manifold struct {
	// number of points, 0 to 4
	Count uint32
	// COMPOUND: index of the child; MESH: of the triangle; else 0
	ChildA uint32
	ChildB uint32
	// TRIBO_METHOD_... that found it
	Method uint32
	// unit, world axes, from B to A
	Normal [3]float64
	// those from `count` on mean nothing
	Points [4]Point
}

var _ = [1]struct{}{}[unsafe.Sizeof(Manifold{})-296]

// SystemContact is tribo_system_contact of system.h.
// One contact between two bodies of a system. 152 bytes.
//
//	Rows: one with dimension 1, or with mu_s = 0 and both lengths 0; three with friction; six with
//	a length > 0. An axis whose length is 0 has no torque.
type SystemContact struct {
	// index of body A, or TRIBO_WORLD
	A uint32
	// index of body B, or TRIBO_WORLD; not that of A
	B uint32
	// 3; or 1: frictionless, one row whatever the pair's friction and the
	// lengths are
	Dimension uint32
	// 0
	reserved uint32
	// normal and arms
	Contact Contact
	// mu_s, mu_d, e
	Pair Material
	// m/s, in contact coordinates: u - target takes the place of u in the
	// laws of contact. Normal: -g/dt lets a gap g close and no more;
	// tangential: the speed of a belt
	Target [3]float64
	// m, >= 0: greatest torque about a tangent, of r_n; 0: none
	Rolling float64
	// m, >= 0: greatest torque about the normal, of r_n; 0: none
	Spinning float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(SystemContact{})-152]

// SystemInfo is tribo_system_info of system.h.
// Certificate: how far the impulses are from the exact law. Per-contact measures are those of
//
//	audit.h with the scales V = |q_c| + |sum |W_cj||r_j|| and P = V / greatest diagonal entry of
//	W_cc; in the bodies form the sum is taken body by body, |J_c| |M^-1| sum |J_j^T||r_j|, which is
//	somewhat more. A contact is judged by mu_d; by mu_s where that is nearer, and then its sliding
//	velocity counts in full: over V in eta, squared in the sums of invariant and siconos. One-row
//	contacts are judged as contacts without friction. With restitution the measures judge the
//	plastic solution that it is built on.
//
//	The torque of a contact with a length is judged beside its impulse, and the worse of the two
//	counts: eta is |tau - P(tau - s omega)| / T with P the nearest torque within the bounds, 1 / s
//	the greatest diagonal entry of its 3x3 matrix W_tau (omega = W_tau tau + ...), T = s Omega, and
//	Omega the scale of omega as V is that of u, with V / arm added to it. The arm is about the
//	radius of gyration: the power of two with the binary exponent (x - y) / 2, rounded down, where x
//	and y are those of the greatest entries on the diagonals of W_cc and W_tau. Sums over contacts
//	(invariant, siconos, energy_scale, |q|) take arm omega for one more u and tau / arm for its r.
//	Cone is max(0, |tau| - bound) / T, misalignment | |omega| tau + bound omega | / (T Omega).
//
//	TRIBO_STOP_TOLERANCE by eta also promises eta V <= a tenth of the greatest |q|: where impulses
//	grow without bound, eta falls though nothing is solved. Of contacts with mu_d above 1 it promises
//	signorini within the tolerance too: eta divides by mu what normal velocities leave open.
type SystemInfo struct {
	// sizeof(tribo_system_info), set by the caller; of a smaller one
	// what lies beyond it is not computed either
	structSize uint32
	// TRIBO_STOP_...
	Stop uint32
	// the TRIBO_SOLVER_... that gave the result
	Solver uint32
	// connected components (islands) of the system
	Components uint32
	// Gauss-Seidel sweeps, of the component that had most
	Sweeps uint64
	// Newton's and interior steps, over all components
	Steps uint64
	// matrices factored
	Factorizations uint64
	// greatest natural-map residual of a contact, no unit
	Eta float64
	// root mean square of the same
	EtaRms float64
	// greatest |min(u_n / V, r_n / P)|
	Signorini float64
	// greatest max(0, |r_t| - mu r_n) / P
	Cone float64
	// greatest | |u_t| r_t + mu r_n u_t | / (P V)
	Misalignment float64
	// as in TRIBO_MEASURE_INVARIANT; |q| = 0 gives 0
	Invariant float64
	// sqrt(sum |r - P_K(r - u')|^2) / max(|q|, |r|, |u|): the measure of
	// Siconos 4.4, not free of units; not divided by less than 2^-52
	Siconos float64
	// change of kinetic energy by the impulses, r . (q + u) / 2, J;
	// without the work of targets
	Energy float64
	// sum |r_c| (|q_c| + |u_c|) / 2, J: what energy is measured
	// against
	EnergyScale float64
	// |change of total linear momentum, impulses of the world counted| /
	// sum m |dv|; 0 in the assembled form
	Linear float64
	// the same of angular momentum about the origin; of meaning where
	// the arms of each contact meet, and no axis is locked
	Angular float64
	// least share of the restitution stage that the energy allowed, 0 to
	// 1; 1 where there is none
	Restitution float64
	// by the clock in the options; 0 without one
	Seconds float64
	// of the workspace that were used
	Bytes uint64
}

var _ = [1]struct{}{}[unsafe.Sizeof(SystemInfo{})-152]

// SparseInfo is tribo_sparse_info of sparse.h.
// What a tribo_sparse has done.
type SparseInfo struct {
	// sizeof(tribo_sparse_info), set by the caller
	structSize uint32
	// SIMPLICIAL or SUPERNODAL: of the last matrix; AUTO: none yet
	Method uint32
	// matrices factored, singular ones counted
	Factorizations uint64
	// patterns analysed
	Analyses uint64
	// right-hand sides
	Solves uint64
	// of memory held now, SuiteSparse's part included
	Bytes uint64
	// numbers in the factors of the last matrix, those of L or of L and
	// U
	Fill uint64
}

var _ = [1]struct{}{}[unsafe.Sizeof(SparseInfo{})-48]

// StepInfo is tribo_step_info of scene.h.
// What a step did, summed over its sub-steps unless stated. Stages that the scene did not need are
//
//	zero.
type StepInfo struct {
	// sizeof(tribo_step_info), set by the caller
	structSize uint32
	// done
	Substeps uint32
	// worst TRIBO_STOP_... of contact and impact solves
	Stop uint32
	// bodies that sleep at the end
	Asleep uint32
	// bodies advanced
	Flights uint64
	// of these, those that turned
	Turns uint64
	// sub-steps with a broad phase
	Broad uint64
	// pairs of bodies collided
	Pairs uint64
	// contact points held by the contact solves
	Contacts uint64
	// of these, those with one row
	Frictionless uint64
	// of these, those with a length of resistance: six rows
	Resisting uint64
	// of these, those with an impulse of the last sub-step
	Matched uint64
	// sub-steps with a contact solve
	ContactSolves uint64
	// sub-steps with an impact solve
	ImpactSolves uint64
	// contact points that had restitution in one
	Impacts uint64
	// sub-steps in which bodies were moved apart
	CorrectionSolves uint64
	// of tribo_system_info, over all solves
	Sweeps uint64
	// the same
	NewtonSteps uint64
	// the same
	Factorizations uint64
	// greatest of contact and impact solves
	Eta float64
	// least share of a restitution stage that the energy allowed; 1
	// where there was none
	Restitution float64
	// greatest overlap at a midpoint, m
	Penetration float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(StepInfo{})-160]

// SceneContact is tribo_scene_contact of scene.h.
// A contact point. A is the body with the lesser id.
type SceneContact struct {
	// id of body A
	A uint32
	// id of body B
	B uint32
	// as in tribo_manifold
	ChildA uint32
	ChildB uint32
	// which features touch
	Id uint64
	// unit, from B to A
	Normal [3]float64
	// from the centre of mass of A to the point, m
	ArmA [3]float64
	// the same from that of B
	ArmB [3]float64
	// of the surfaces, m; negative inside
	Distance float64
	// on A, world axes, N s, in the last sub-step; without impacts
	Impulse [3]float64
	// of rolling and spinning resistance on A, world axes, N m s, the same
	Torque [3]float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(SceneContact{})-152]

// SceneEvent is tribo_scene_event of scene.h.
// What two bodies did to each other in a step. They touch in a step if in a sub-step of it they
//
//	exchange an impulse or a distance is not positive.
type SceneEvent struct {
	// TRIBO_EVENT_...
	Kind uint32
	// id
	A uint32
	// id, greater than a
	B uint32
	// contact points with restitution, over the sub-steps
	Impacts uint32
	// on A, world axes, N s: all of the step, impacts included
	Impulse [3]float64
	// sum of the normal impulses, N s
	Normal float64
}

var _ = [1]struct{}{}[unsafe.Sizeof(SceneEvent{})-48]
