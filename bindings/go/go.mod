module tribo.dev/go/tribo

go 1.24
