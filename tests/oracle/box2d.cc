#include "box2d.h"

#include <vector>

#include <box2d/box2d.h>

namespace
{

float narrow(double x)
{
    return static_cast<float>(x);
}

/* Contact points as the solver left them. */
class Listener : public b2ContactListener
{
  public:
    std::vector<box2d_contact> contacts;

    void PostSolve(b2Contact *contact, const b2ContactImpulse *impulse) override
    {
        b2WorldManifold manifold;
        contact->GetWorldManifold(&manifold);
        for (int i = 0; i < impulse->count; i++) {
            box2d_contact out;
            out.a = number(contact->GetFixtureA());
            out.b = number(contact->GetFixtureB());
            out.point[0] = manifold.points[i].x;
            out.point[1] = manifold.points[i].y;
            out.normal[0] = -manifold.normal.x;
            out.normal[1] = -manifold.normal.y;
            out.normal_impulse = impulse->normalImpulses[i];
            out.tangent_impulse = impulse->tangentImpulses[i];
            contacts.push_back(out);
        }
    }

  private:
    static int number(b2Fixture *fixture)
    {
        return static_cast<int>(fixture->GetBody()->GetUserData().pointer);
    }
};

} // namespace

struct box2d_world {
    b2World world;
    Listener listener;
    std::vector<b2Body *> bodies;

    explicit box2d_world(const b2Vec2 &gravity) : world(gravity)
    {
        world.SetContactListener(&listener);
        world.SetContinuousPhysics(false);
        world.SetWarmStarting(false);
        world.SetAllowSleeping(false);
    }
};

box2d_world *box2d_create(double gravity_x, double gravity_y)
{
    return new box2d_world(b2Vec2(narrow(gravity_x), narrow(gravity_y)));
}

void box2d_destroy(box2d_world *world)
{
    delete world;
}

int box2d_add(box2d_world *world, const box2d_body *body)
{
    b2BodyDef def;
    def.type = body->mass > 0.0 ? b2_dynamicBody : b2_staticBody;
    def.position.Set(narrow(body->position[0]), narrow(body->position[1]));
    def.angle = narrow(body->angle);
    def.linearVelocity.Set(narrow(body->velocity[0]), narrow(body->velocity[1]));
    def.angularVelocity = narrow(body->spin);
    def.userData.pointer = world->bodies.size();
    b2Body *made = world->world.CreateBody(&def);
    b2CircleShape disc;
    b2PolygonShape box;
    b2FixtureDef fixture;
    if (body->half[1] > 0.0) {
        box.SetAsBox(narrow(body->half[0]), narrow(body->half[1]));
        fixture.shape = &box;
    } else {
        disc.m_radius = narrow(body->half[0]);
        fixture.shape = &disc;
    }
    fixture.friction = narrow(body->mu);
    fixture.restitution = narrow(body->e);
    fixture.restitutionThreshold = narrow(body->threshold);
    made->CreateFixture(&fixture);
    if (body->mass > 0.0) {
        b2MassData data;
        data.mass = narrow(body->mass);
        data.center.SetZero();
        data.I = narrow(body->moment);
        made->SetMassData(&data);
    }
    world->bodies.push_back(made);
    return static_cast<int>(world->bodies.size()) - 1;
}

void box2d_step(box2d_world *world, double dt, int velocity_iterations, int position_iterations)
{
    world->listener.contacts.clear();
    world->world.Step(narrow(dt), velocity_iterations, position_iterations);
}

void box2d_get(const box2d_world *world, int body, double state[6])
{
    const b2Body *b = world->bodies[static_cast<std::size_t>(body)];
    state[0] = b->GetPosition().x;
    state[1] = b->GetPosition().y;
    state[2] = b->GetAngle();
    state[3] = b->GetLinearVelocity().x;
    state[4] = b->GetLinearVelocity().y;
    state[5] = b->GetAngularVelocity();
}

int box2d_contacts(const box2d_world *world, int capacity, box2d_contact *contacts)
{
    int count = 0;
    for (const box2d_contact &c : world->listener.contacts) {
        if (count < capacity) {
            contacts[count++] = c;
        }
    }
    return count;
}

double box2d_slop(void)
{
    return b2_linearSlop;
}
