package tribo_test

import (
	"fmt"
	"log"

	"tribo.dev/go/tribo"
)

// A ball falls onto the floor, sliding, and rolls on at five sevenths of its speed.
func Example() {
	material := tribo.Material{MuS: 0.3, MuD: 0.3}
	scene, err := tribo.NewScene([3]float64{0, 0, -9.81})
	if err != nil {
		log.Fatal(err)
	}
	defer scene.Close()

	ground, _ := tribo.HalfSpace([3]float64{0, 0, 1}, 0)
	sphere, _ := tribo.Sphere(0.5)
	ball, _ := tribo.Solid(sphere, 4, material)
	ball.State.Position[2] = 1
	ball.State.Velocity[0] = 7
	if _, err := scene.Add(tribo.Fixed(ground, material)); err != nil {
		log.Fatal(err)
	}
	id, err := scene.Add(ball)
	if err != nil {
		log.Fatal(err)
	}
	for range 2400 {
		if _, err := scene.Step(1.0/1200, tribo.StepOptions{}); err != nil {
			log.Fatal(err)
		}
	}
	end, _ := scene.Body(id)
	fmt.Printf("%.6f m/s, %.6f rad/s\n", end.Velocity[0], end.AngularVelocity[1])
	// Output: 5.000408 m/s, 10.000816 rad/s
}
