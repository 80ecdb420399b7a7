package tribo

import (
	"errors"
	"math"
	"runtime"
	"testing"
)

func expect(t *testing.T, err, want error) {
	t.Helper()
	if !errors.Is(err, want) {
		t.Errorf("error is %v, not %v", err, want)
	}
}

func must[T any](v T, err error) T {
	if err != nil {
		panic(err)
	}
	return v
}

func TestContactRefuses(t *testing.T) {
	w := [6]float64{1, 0, 0, 1, 0, 1}
	p := [3]float64{7, 7, 7}
	expect(t, Solve(&w, &[3]float64{math.NaN()}, 0.5, 0.5, &p), ErrNotFinite)
	expect(t, Solve(&w, &[3]float64{-1}, 0.1, 0.5, &p), ErrFriction)
	if p != [3]float64{7, 7, 7} {
		t.Error("an output was touched")
	}
	_, err := BodyOf(-1, [9]float64{1, 0, 0, 0, 1, 0, 0, 0, 1})
	expect(t, err, ErrMass)
	_, err = NamedMaterial("cheese on moon")
	expect(t, err, ErrName)
}

func TestBatchRefuses(t *testing.T) {
	w := []float64{1, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 1}
	b := []float64{math.NaN(), 0, 0, -1, 0, 0}
	mu, p, statuses := []float64{1, 1, 1, 1}, make([]float64, 6), make([]int32, 2)
	expect(t, BatchSolve(IsaBest, w, b, mu, p[:5], nil, nil), ErrLength)
	expect(t, BatchSolve(IsaBest, w[:6], b, mu, p, nil, nil), ErrLength)
	expect(t, BatchSolve(IsaBest, w, b, mu, p, nil, statuses[:1]), ErrLength)
	expect(t, BatchSolve(99, w, b, mu, p, nil, nil), ErrOption)
	expect(t, BatchSolve(IsaBest, w, b, mu, p, nil, statuses), ErrNotFinite)
	if Error(statuses[0]) != ErrNotFinite || statuses[1] != 0 || p[3] != 1 || p[0] != 0 {
		t.Error("each contact has its own status", statuses, p)
	}
}

func TestShapesRefuse(t *testing.T) {
	_, err := Sphere(-1)
	expect(t, err, ErrShape)
	_, err = Hull(make([]float64, 24))
	expect(t, err, ErrDegenerate)
	_, err = Hull(make([]float64, 25))
	expect(t, err, ErrLength)
	_, err = Mesh(make([]float64, 9), []uint32{0, 1, 7})
	expect(t, err, ErrIndex)
	_, err = NewTree(0, 0)
	expect(t, err, ErrRange)
	bad := must(Convex(func([3]float64) [3]float64 { panic("no") }, [3]float64{}, 1))
	_, err = Touch(bad, At(0, 0, 0), must(Sphere(1)), At(0, 0, 0), 0)
	expect(t, err, ErrSupport)
}

func TestUsersShape(t *testing.T) {
	own := must(Convex(func(d [3]float64) [3]float64 {
		out, _ := Normalize(d)
		return out
	}, [3]float64{}, 1))
	found := must(Touch(own, At(0, 0, 1.9), must(Sphere(1)), At(0, 0, 0), 0))
	if len(found) != 1 || math.Abs(found[0].Points[0].Distance+0.1) > 1e-6 {
		t.Error(found)
	}
}

func ballScene() (*Scene, uint32) {
	scene := must(NewScene([3]float64{0, 0, -9.81}))
	must(scene.Add(Fixed(must(HalfSpace([3]float64{0, 0, 1}, 0)), Material{})))
	ball := must(Solid(must(Sphere(0.5)), 1, Material{}))
	ball.State.Position[2] = 0.75
	return scene, must(scene.Add(ball))
}

func TestSceneRefuses(t *testing.T) {
	scene, ball := ballScene()
	_, err := scene.Step(-1, StepOptions{})
	expect(t, err, ErrTimeStep)
	_, err = scene.Body(99)
	expect(t, err, ErrIndex)
	expect(t, scene.Remove(99), ErrIndex)
	expect(t, scene.Load(Saved{}), ErrNull)
	if must(scene.Body(ball)).Position[2] != 0.75 {
		t.Error("the scene changed")
	}
	expect(t, scene.Close(), nil)
	_, err = scene.Step(0.01, StepOptions{})
	expect(t, err, ErrClosed)
	_, err = scene.Body(ball)
	expect(t, err, ErrClosed)
	expect(t, scene.Close(), ErrClosed)
	system := must(NewSystem())
	expect(t, system.Close(), nil)
	expect(t, system.Solve(nil, nil, SystemOptions{}), ErrClosed)
}

// A support function holds the step open while another goroutine tries.
func TestNoSecondGoroutineInside(t *testing.T) {
	inside, leave := make(chan bool, 1000), make(chan bool)
	wait := false
	own := must(Convex(func(d [3]float64) [3]float64 {
		if wait {
			inside <- true
			<-leave
		}
		out, _ := Normalize(d)
		return out
	}, [3]float64{}, 1))
	scene := must(NewScene([3]float64{}))
	must(scene.Add(Fixed(must(Box(1, 1, 1)), Material{})))
	body := Fixed(own, Material{})
	body.Kind = BodyDynamic
	body.State = must(BodyOf(1, [9]float64{1, 0, 0, 0, 1, 0, 0, 0, 1}))
	body.State.Position[2] = 1.99
	must(scene.Add(body))
	wait = true
	done := make(chan error)
	go func() {
		_, err := scene.Step(0.01, StepOptions{})
		done <- err
	}()
	<-inside
	_, err := scene.Step(0.01, StepOptions{})
	expect(t, err, ErrBusy)
	expect(t, scene.Close(), ErrBusy)
	close(leave)
	expect(t, <-done, nil)
}

func TestSavedScenes(t *testing.T) {
	scene := must(NewScene([3]float64{0, 0, -9.81}))
	must(scene.Add(Fixed(must(HalfSpace([3]float64{0, 0, 1}, 0)), Material{})))
	var points []float64
	for i := range 8 {
		points = append(points, float64(i&1)-0.5, float64(i>>1&1)-0.5, float64(i>>2)-0.5)
	}
	cube := must(Solid(must(Hull(points)), 1, Material{}))
	cube.State.Position[2] = 0.6
	id := must(scene.Add(cube))
	saved := must(scene.Save())
	cube = SceneBody{}
	var ends []Saved
	for range 2 {
		for range 50 {
			must(scene.Step(0.0078125, StepOptions{}))
		}
		ends = append(ends, must(scene.Save()))
		expect(t, scene.Remove(id), nil)
		runtime.GC() // the hull lives on in what was saved
		expect(t, scene.Load(saved), nil)
	}
	if !ends[0].Equal(ends[1]) || ends[0].Equal(saved) {
		t.Error("a saved scene does not go on to the bit")
	}
}

// A ball slows by 5/7 rolling g / R.
func TestRollingResistance(t *testing.T) {
	material := Material{MuS: 0.5, MuD: 0.5}
	scene := must(NewScene([3]float64{0, 0, -10}))
	must(scene.Add(Fixed(must(HalfSpace([3]float64{0, 0, 1}, 0)), material)))
	ball := must(Solid(must(Sphere(0.5)), 1, material))
	ball.State.Position[2] = 0.5
	ball.State.Velocity[0] = 1
	ball.State.AngularVelocity[1] = 2
	ball.Rolling = 0.02
	id := must(scene.Add(ball))
	for range 100 {
		must(scene.Step(0.01, StepOptions{}))
	}
	if left := must(scene.Body(id)).Velocity[0]; math.Abs(left-(1-5.0/7*0.02*10/0.5)) > 1e-9 {
		t.Error(left)
	}
	ball.Spinning = -1
	_, err := scene.Add(ball)
	expect(t, err, ErrFriction)
}

func TestTree(t *testing.T) {
	tree := must(NewTree(8, 0))
	must(tree.Add([3]float64{}, [3]float64{1, 1, 1}))
	second := must(tree.Add([3]float64{0.5}, [3]float64{2, 1, 1}))
	if len(must(tree.Pairs())) != 2 || len(must(tree.QueryBox([3]float64{}, [3]float64{1, 1, 1}))) != 2 {
		t.Error("two boxes overlap")
	}
	expect(t, tree.Move(second, [3]float64{5, 5, 5}, [3]float64{6, 6, 6}), nil)
	if len(must(tree.Pairs())) != 0 {
		t.Error("they do not any more")
	}
	expect(t, tree.Remove(second), nil)
	expect(t, tree.Remove(second), ErrIndex)
}

const benchCount = 10000

func benchInput() (w, b, mu []float64) {
	d := draws(1)
	for range benchCount {
		matrix, sides, pair := d.matrix(), d.sides(), d.pair()
		w, b, mu = append(w, matrix[:]...), append(b, sides[:]...), append(mu, pair.MuS, pair.MuD)
	}
	return w, b, mu
}

func BenchmarkSolve(b *testing.B) {
	w, v, mu := benchInput()
	var p [3]float64
	for k := 0; b.Loop(); k = (k + 1) % benchCount {
		_ = Solve((*[6]float64)(w[6*k:]), (*[3]float64)(v[3*k:]), mu[2*k], mu[2*k+1], &p)
	}
}

func BenchmarkBatchSolve(b *testing.B) {
	w, v, mu := benchInput()
	p, modes := make([]float64, 3*benchCount), make([]uint32, benchCount)
	for b.Loop() {
		_ = BatchSolve(IsaBest, w, v, mu, p, modes, nil)
	}
}
