// Package src has no code; without it `go mod vendor` would leave its C out.
package src
