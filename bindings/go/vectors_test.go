package tribo

// The test vectors of the C library, replayed bit for bit: see vectors.c for the rule.

import (
	"encoding/json"
	"errors"
	"fmt"
	"math"
	"os"
	"testing"
)

type draws uint64

func (d *draws) unit() float64 {
	*d += 0x9e3779b97f4a7c15
	z := uint64(*d)
	z = (z ^ z>>30) * 0xbf58476d1ce4e5b9
	z = (z ^ z>>27) * 0x94d049bb133111eb
	z ^= z >> 31
	return float64(z>>11) / (1 << 53)
}

func (d *draws) side() float64 {
	return 2*d.unit() - 1
}

func (d *draws) sides() (out [3]float64) {
	for i := range out {
		out[i] = d.side()
	}
	return out
}

func (d *draws) matrix() (w [6]float64) {
	for i := range w {
		if i == 0 || i == 3 || i == 5 {
			w[i] = 2 + d.side()
		} else {
			w[i] = 0.5 * d.side()
		}
	}
	return w
}

func (d *draws) pair() Material {
	muS := 2 * d.unit()
	muD := d.unit() * muS
	return Material{MuS: muS, MuD: muD, E: d.unit()}
}

type hash uint64

func (h *hash) put(words ...uint64) {
	for _, word := range words {
		for i := range 8 {
			*h = (*h ^ hash(word>>(8*i)&0xff)) * 0x100000001b3
		}
	}
}

func (h *hash) numbers(numbers ...float64) {
	for _, x := range numbers {
		h.put(math.Float64bits(x))
	}
}

func doSolve(d *draws, h *hash, _ int) error {
	w, b, pair := d.matrix(), d.sides(), d.pair()
	p, info, err := SolveWithInfo(w, b, pair.MuS, pair.MuD)
	if err == nil {
		h.put(0)
		h.numbers(p[:]...)
		h.put(uint64(info.Mode))
	}
	return err
}

func doImpact(d *draws, h *hash, i int) error {
	w, u, pair := d.matrix(), d.sides(), d.pair()
	p, info, err := Impact(w, u, pair, uint32(i%8))
	if err == nil {
		h.put(0)
		h.numbers(p[:]...)
		h.put(uint64(info.Mode))
		h.numbers(info.Energy)
	}
	return err
}

func boxMass(hx, hy, hz float64) (float64, [9]float64) {
	box, _ := Box(hx, hy, hz)
	mass, _, inertia, _ := box.Mass(1000)
	return mass, inertia
}

func drawBox(d *draws) Body {
	hx := 0.5 + d.unit()
	hy := 0.5 + d.unit()
	mass, inertia := boxMass(hx, hy, 0.5+d.unit())
	body, _ := BodyOf(mass, inertia)
	body.Position = d.sides()
	body.Orientation, _ = Rotation(d.sides())
	body.Velocity = d.sides()
	body.AngularVelocity = d.sides()
	return body
}

func doCollide(d *draws, h *hash, _ int) error {
	a, b := drawBox(d), drawBox(d)
	point := d.sides()
	normal, _ := Normalize(d.sides())
	info, err := Collide(&a, &b, point, normal, d.pair(), LawAlgebraic)
	if err == nil {
		h.put(0)
		for _, body := range []Body{a, b} {
			h.numbers(body.Velocity[:]...)
			h.numbers(body.AngularVelocity[:]...)
		}
		h.numbers(info.Impulse[:]...)
		h.numbers(info.Energy)
	}
	return err
}

const batch = 100

func putBatch(h *hash, p []float64, modes []uint32) {
	h.put(0)
	h.numbers(p...)
	for _, mode := range modes {
		h.put(uint64(mode))
	}
}

func drawBatch(d *draws) (w, b []float64, pairs []Material) {
	for range batch {
		matrix, sides := d.matrix(), d.sides()
		w, b, pairs = append(w, matrix[:]...), append(b, sides[:]...), append(pairs, d.pair())
	}
	return w, b, pairs
}

func doBatchSolve(d *draws, h *hash, _ int) error {
	w, b, pairs := drawBatch(d)
	var mu []float64
	for _, pair := range pairs {
		mu = append(mu, pair.MuS, pair.MuD)
	}
	p, modes := make([]float64, 3*batch), make([]uint32, batch)
	err := BatchSolve(IsaBest, w, b, mu, p, modes, nil)
	putBatch(h, p, modes)
	return err
}

func doBatchImpact(d *draws, h *hash, _ int) error {
	w, u, pairs := drawBatch(d)
	p, modes := make([]float64, 3*batch), make([]uint32, batch)
	err := BatchImpact(IsaBest, w, u, pairs, p, modes, nil)
	putBatch(h, p, modes)
	return err
}

func drawShape(d *draws, kind int) (Shape, Pose) {
	a := 0.25 + 0.5*d.unit()
	b := 0.25 + 0.5*d.unit()
	c := 0.25 + 0.5*d.unit()
	position := d.sides()
	pose := At(0.5*position[0], 0.5*position[1], 0.5*position[2])
	pose.Orientation, _ = Rotation(d.sides())
	var shape Shape
	switch kind {
	case 0:
		shape, _ = Sphere(a)
	case 1:
		shape, _ = Box(a, b, c)
	case 2:
		shape, _ = Capsule(a, b)
	case 3:
		shape, _ = Cylinder(a, b)
	case 4:
		shape, _ = Cone(a, b)
	default:
		shape, _ = Ellipsoid(a, b, c)
	}
	return shape, pose
}

func doManifold(d *draws, h *hash, i int) error {
	a, poseA := drawShape(d, i%6)
	b, poseB := drawShape(d, i/6%6)
	manifolds, err := Touch(a, poseA, b, poseB, 0.015625)
	if err != nil {
		return err
	}
	h.put(0, uint64(len(manifolds)))
	for _, m := range manifolds {
		h.put(uint64(m.Count))
		h.numbers(m.Normal[:]...)
		for _, point := range m.Points[:m.Count] {
			h.numbers(point.ArmA[:]...)
			h.numbers(point.ArmB[:]...)
			h.numbers(point.Distance)
			h.put(point.Id)
		}
	}
	return nil
}

func doSystem(d *draws, h *hash, i int) error {
	mass, inertia := boxMass(0.5, 0.5, 0.5)
	var bodies []Body
	var contacts []SystemContact
	for k := range 5 {
		body, _ := BodyOf(mass, inertia)
		body.Position[2] = float64(k) + 0.5
		body.Velocity = [3]float64{0.125 * d.side(), 0.125 * d.side(), -0.015625}
		spin := d.sides()
		body.AngularVelocity = [3]float64{0.125 * spin[0], 0.125 * spin[1], 0.125 * spin[2]}
		bodies = append(bodies, body)
		for j := range 4 {
			x, y := float64(j%2)-0.5, float64(j/2)-0.5
			c := SystemContact{A: uint32(k), B: World, Dimension: 3}
			if k > 0 {
				c.B = uint32(k - 1)
			}
			c.Contact.Normal[2] = 1
			c.Contact.ArmA = [3]float64{x, y, -0.5}
			c.Contact.ArmB = [3]float64{x, y, 0.5}
			c.Pair.MuS, c.Pair.MuD = 0.5, 0.5
			contacts = append(contacts, c)
		}
	}
	system, err := NewSystem()
	if err != nil {
		return err
	}
	defer system.Close()
	options := SystemOptions{Solver: uint32(1 + i%2), Tolerance: 1.0 / (1 << 30)}
	if err := system.Solve(bodies, contacts, options); err != nil {
		return err
	}
	h.put(0)
	h.numbers(system.Impulses...)
	h.numbers(system.Velocities...)
	return nil
}

func doScene(d *draws, h *hash, _ int) error {
	material := Material{MuS: 0.5, MuD: 0.5, E: 0.25}
	scene, err := NewScene([3]float64{0, 0, -9.8125})
	if err != nil {
		return err
	}
	defer scene.Close()
	ground, _ := HalfSpace([3]float64{0, 0, 1}, 0)
	scene.Add(Fixed(ground, material))
	for k := range 10 {
		shape := [4]func() (Shape, error){
			func() (Shape, error) { return Sphere(0.25) },
			func() (Shape, error) { return Box(0.25, 0.25, 0.25) },
			func() (Shape, error) { return Capsule(0.25, 0.25) },
			func() (Shape, error) { return Cylinder(0.25, 0.25) },
		}[k%4]
		made, _ := shape()
		body, _ := Solid(made, 1000, material)
		x := d.side()
		body.State.Position = [3]float64{x, d.side(), 1 + float64(k)}
		body.State.Velocity = d.sides()
		body.State.AngularVelocity = d.sides()
		if _, err := scene.Add(body); err != nil {
			return err
		}
	}
	for step := 1; step <= 1000; step++ {
		if _, err := scene.Step(0.00390625, StepOptions{}); err != nil {
			return err
		}
		for k := uint32(1); step%100 == 0 && k <= 10; k++ {
			body, _ := scene.Body(k)
			h.put(0)
			h.numbers(body.Position[:]...)
			h.numbers(body.Orientation[:]...)
			h.numbers(body.Velocity[:]...)
			h.numbers(body.AngularVelocity[:]...)
		}
	}
	return nil
}

type vectorFile struct {
	Statuses []struct {
		Value int32
		Name  string
		Text  string
	}
	Sets []struct {
		Name  string
		Seed  uint64
		Count int
		Hash  string
	}
}

func readVectors(t *testing.T) (v vectorFile) {
	path := os.Getenv("TRIBO_VECTORS")
	if path == "" {
		path = "../vectors.json"
	}
	text, err := os.ReadFile(path)
	if err != nil {
		t.Skipf("no test vectors: %v (TRIBO_VECTORS names the file)", err)
	}
	if err := json.Unmarshal(text, &v); err != nil {
		t.Fatal(err)
	}
	return v
}

func TestVectors(t *testing.T) {
	sets := map[string]func(*draws, *hash, int) error{
		"solve": doSolve, "impact": doImpact, "collide": doCollide, "batch_solve": doBatchSolve,
		"batch_impact": doBatchImpact, "manifold": doManifold, "system": doSystem,
		"scene": doScene,
	}
	for _, expected := range readVectors(t).Sets {
		t.Run(expected.Name, func(t *testing.T) {
			d, h := draws(expected.Seed), hash(0xcbf29ce484222325)
			for i := range expected.Count {
				var e Error
				if err := sets[expected.Name](&d, &h, i); errors.As(err, &e) {
					h.put(uint64(e))
				} else if err != nil {
					t.Fatal(err)
				}
			}
			if seen := fmt.Sprintf("%016x", uint64(h)); seen != expected.Hash {
				t.Errorf("hash %s, not %s", seen, expected.Hash)
			}
		})
	}
}

func TestStatuses(t *testing.T) {
	for _, status := range readVectors(t).Statuses {
		if e := Error(status.Value); e.Name() != status.Name || e.Error() != "tribo: "+status.Text {
			t.Errorf("%d is %q, %q", status.Value, e.Name(), e)
		}
	}
}
