// Package include has no code; without it `go mod vendor` would leave its C out.
package include
