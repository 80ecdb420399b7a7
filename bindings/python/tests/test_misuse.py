"""What is refused, and how: an exception of the right kind, nothing changed, no crash."""

import pickle
import threading

import numpy as np
import pytest
import tribo
from tribo import errors, shape

NAN = float("nan")


def test_every_status_is_an_exception(vectors):
    for status in vectors["statuses"]:
        if status["value"] != 0:
            with pytest.raises(tribo.TriboError, match="here: ") as caught:
                errors.check(status["value"], "here")
            assert caught.value.status == status["value"]
            assert status["text"] in str(caught.value)
            assert type(caught.value) is not tribo.TriboError
    with pytest.raises(tribo.TriboError):
        errors.check(999)


def batch(n=4):
    w = np.tile([1.0, 0, 0, 1, 0, 1], (n, 1))
    return w, -np.ones((n, 3)), np.full((n, 2), 0.5)


@pytest.mark.parametrize("index, change, error", [
    (0, lambda x: x.astype(np.float32), TypeError),
    (0, lambda x: x.astype(">f8"), TypeError),
    (1, lambda x: x.tolist(), TypeError),
    (0, lambda x: np.asfortranarray(x), ValueError),
    (1, lambda x: np.zeros((8, 3))[::2], ValueError),
    (1, lambda x: x[:-1], ValueError),
    (2, lambda x: x[:, :1].copy(), ValueError),
    (0, lambda x: np.frombuffer(bytes(x.nbytes + 1), np.uint8)[1:].view(np.float64), ValueError),
    (1, lambda x: np.full_like(x, NAN), errors.NotFiniteError),
])
def test_batch_refuses_arrays_that_do_not_fit(index, change, error):
    arrays = list(batch())
    arrays[index] = change(arrays[index])
    with pytest.raises(error):
        tribo.batch_solve(*arrays)


def test_batch_writes_only_where_it_may():
    w, b, mu = batch()
    p = np.zeros((4, 3))
    p.flags.writeable = False
    with pytest.raises(ValueError, match="writable"):
        tribo.batch_solve(w, b, mu, p)


def test_batch_tells_each_contact():
    w, b, mu = batch()
    b[2, 0] = NAN
    statuses = np.zeros(4, np.int32)
    p, _ = tribo.batch_solve(w, b, mu, statuses=statuses)
    assert statuses.tolist() == [0, 0, errors.NotFiniteError.status, 0]
    assert (p[[0, 1, 3], 0] > 0).all() and (p[2] == 0).all()


def test_batch_is_zero_copy():
    w, b, mu = batch()
    p = np.zeros((4, 3))
    out, _ = tribo.batch_solve(w, b, mu, p)
    assert out is p and (p[:, 0] > 0).all()


def test_records_are_not_written_to():
    bodies = tribo.bodies(2)
    with pytest.raises(TypeError, match="array of one"):
        tribo.advance(bodies[0], 1.0)
    tribo.advance(bodies[0:1], 1.0)


def test_one_contact_refuses():
    w = [1, 0, 0, 1, 0, 1]
    with pytest.raises(errors.NotFiniteError):
        tribo.solve(w, [NAN, 0, 0], 0.5)
    with pytest.raises(errors.FrictionError):
        tribo.solve(w, [-1, 0, 0], 0.1, 0.5)
    with pytest.raises(ValueError):
        tribo.solve(w, [1, 2], 0.5)
    with pytest.raises((TypeError, ValueError)):
        tribo.solve(w, ["a", 0, 0], 0.5)
    with pytest.raises(errors.RestitutionError):
        tribo.Material(0.5, 0.5, 2.0)
    with pytest.raises(errors.UnknownNameError):
        tribo.Material.named("cheese on moon")
    with pytest.raises(errors.MassError):
        tribo.body(-1.0, np.eye(3))


def ball_scene():
    scene = tribo.Scene()
    scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC)
    return scene, scene.add(shape.sphere(0.5), density=1.0, position=(0, 0, 0.75))


def test_scene_refuses():
    scene, ball = ball_scene()
    with pytest.raises(errors.TimeStepError):
        scene.step(-1.0)
    with pytest.raises(IndexError):
        scene.body(99)
    with pytest.raises((OverflowError, TypeError)):
        scene.body(-1)
    with pytest.raises(TypeError):
        scene.add(shape.sphere(1.0))
    with pytest.raises(errors.ShapeError):
        shape.sphere(-1.0)
    with pytest.raises(TypeError):
        scene.load(np.zeros(10))
    with pytest.raises(TypeError):
        pickle.dumps(scene)
    assert scene.body(ball)["position"][2] == 0.75


def test_use_after_close():
    scene, ball = ball_scene()
    with scene:
        scene.step(0.01)
    scene.close()
    for call in (lambda: scene.step(0.01), lambda: scene.body(ball), lambda: len(scene),
                 scene.contacts, scene.save, lambda: scene.remove(ball)):
        with pytest.raises(ValueError, match="closed"):
            call()
    system = tribo.System()
    system.close()
    with pytest.raises(ValueError, match="closed"):
        system.solve(tribo.bodies(0), tribo.zeros("system_contact", 0))


def test_no_second_thread_inside():
    """A support function written in Python holds the step open while another thread tries."""
    inside, leave = threading.Event(), threading.Event()

    def support(direction):
        inside.set()
        leave.wait(10)
        return direction / np.linalg.norm(direction)

    scene = tribo.Scene()
    scene.add(shape.box(1, 1, 1), kind=tribo.Kind.STATIC)
    leave.set()  # bounds are taken when the body is added
    scene.add(shape.convex(support, (0, 0, 0), 1.0), position=(0, 0, 1.99),
              state=tribo.body(1.0, np.eye(3), position=(0, 0, 1.99)))
    inside.clear()
    leave.clear()
    thread = threading.Thread(target=lambda: scene.step(0.01))
    thread.start()
    assert inside.wait(10)
    with pytest.raises(RuntimeError, match="in use"):
        scene.step(0.01)
    with pytest.raises(RuntimeError, match="in use"):
        scene.close()
    leave.set()
    thread.join()
    scene.step(0.01)


def test_support_function_that_raises():
    def support(_):
        raise RuntimeError("no")

    with pytest.raises(errors.SupportError):
        tribo.touch(shape.convex(support, (0, 0, 0), 1.0), shape.sphere(1.0))


def test_saved_states_keep_their_shapes():
    scene = tribo.Scene()
    points = np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)]) - 0.5
    scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC)
    id_ = scene.add(shape.hull(points), density=1.0, position=(0, 0, 0.6))
    saved = scene.save()
    ends = []
    for _ in range(2):
        for _ in range(50):
            scene.step(1 / 128)
        ends.append(scene.save())
        scene.remove(id_)  # its hull lives on in what was saved
        scene.load(saved)
    assert ends[0] == ends[1] and ends[0] != saved


def test_rolling_resistance():
    """A ball slows by 5/7 rolling g / R, and stops; a length below 0 is refused."""
    with tribo.Scene((0, 0, -10.0)) as scene:
        material = tribo.Material(0.5, 0.5)
        scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC, material=material)
        ball = scene.add(shape.sphere(0.5), density=1.0, position=(0, 0, 0.5), velocity=(1, 0, 0),
                         angular_velocity=(0, 2, 0), material=material, rolling=0.02)
        for _ in range(100):
            scene.step(0.01)
        assert abs(scene.body(ball)["velocity"][0] - (1 - 5 / 7 * 0.02 * 10 / 0.5)) < 1e-9
        with pytest.raises(errors.FrictionError):
            scene.add(shape.sphere(0.5), density=1.0, spinning=-1.0)


def test_executors_change_no_bit():
    from concurrent.futures import ThreadPoolExecutor

    ends = []
    for tasks in (0, 2):
        with tribo.Scene() as scene, ThreadPoolExecutor(2) as pool:
            scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC,
                      material=tribo.Material(0.5, 0.5))
            for k in range(8):
                scene.add(shape.box(0.5, 0.5, 0.5), density=1.0, position=(0, 0, 0.5 + k),
                          material=tribo.Material(0.5, 0.5))
            for _ in range(20):
                scene.step(1 / 64, tasks=tasks, executor=pool if tasks else None)
            ends.append(scene.save())
    assert ends[0] == ends[1]


def test_progress_cancels_a_solve():
    bodies, contacts = tribo.bodies(1), tribo.zeros("system_contact", 4)
    bodies[0] = tribo.body(1.0, np.eye(3), velocity=(1, 0, -1))[0]
    for j, c in enumerate(contacts):
        c["b"], c["dimension"] = tribo.WORLD, 3
        c["contact"]["normal"] = (0, 0, 1)
        c["contact"]["arm_a"] = ((-1, 1)[j % 2], (-1, 1)[j // 2], -1)
        c["pair"]["mu_s"] = c["pair"]["mu_d"] = 0.5
    with tribo.System() as system:
        seen = []
        system.solve(bodies, contacts, progress=lambda info: bool(seen.append(info["eta"])) or True)
        assert system.stop == tribo.Stop.CANCEL and seen
        system.solve(bodies, contacts)
        assert system.stop == tribo.Stop.TOLERANCE
        system.apply(bodies)
        assert abs(bodies["velocity"][0, 2]) < 1e-9
