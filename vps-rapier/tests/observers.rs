//! Observers see what becomes of each contact, and change nothing.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast)]

mod support;

use std::cell::RefCell;
use std::collections::BTreeMap;

use vps_build::{Mesh, models};
use vps_core::Event;
use vps_rapier::rapier3d::parry::query::{
    ContactManifold, ContactManifoldsWorkspace, PersistentQueryDispatcher,
};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{
    ContactEvent, Manifolds, PairContact, PairDropReason, PairEvent, Role, TurnReason,
    VpsDispatcher, VpsShape,
};

type Contacts = Vec<ContactManifold<(), ()>>;

fn vps(mesh: &Mesh) -> VpsShape {
    VpsShape::new(support::asset(mesh, 600))
}

/// The contacts of a step, found with an observer, and its events. Without one they are the same.
fn step(
    dispatcher: VpsDispatcher,
    [a, b]: [&dyn Shape; 2],
    pose: &Pose,
    contacts: &mut Contacts,
) -> Vec<PairEvent> {
    let mut plain = contacts.clone();
    let mut workspace: Option<ContactManifoldsWorkspace> = None;
    dispatcher
        .contact_manifolds(pose, a, b, 0.02, &mut plain, &mut workspace)
        .unwrap();
    let events = RefCell::new(Vec::new());
    let observer = |event| events.borrow_mut().push(event);
    dispatcher
        .observe_contact_manifolds(pose, a, b, 0.02, contacts, &observer)
        .unwrap();
    assert_eq!(format!("{plain:?}"), format!("{contacts:?}"));
    events.into_inner()
}

/// Each contact that is found has one end, and those kept are those of the manifolds.
fn check(events: &[PairEvent], contacts: &Contacts) {
    let key = |contact: &PairContact, is_previous: bool| {
        let [first, second] = contact.ids.map(|id| id.0);
        (is_previous, first, second)
    };
    let (mut unfinished, mut normals) = (BTreeMap::new(), BTreeMap::new());
    let (mut kept, mut kept_previous) = (Vec::new(), Vec::new());
    for event in events {
        let PairEvent::Contact {
            contact,
            is_previous,
            event,
        } = event
        else {
            continue;
        };
        let key = key(contact, *is_previous);
        // The normal it was last turned to.
        if let Some(normal) = normals.get(&key) {
            assert_eq!(contact.normals[0], *normal);
        }
        match event {
            ContactEvent::Found => *unfinished.entry(key).or_insert(0) += 1,
            ContactEvent::NormalTurned { normal, .. } => {
                assert_ne!(contact.normals[0], *normal);
                normals.insert(key, *normal);
            }
            ContactEvent::Merged | ContactEvent::Dropped(_) => {
                *unfinished.get_mut(&key).unwrap() -= 1;
            }
            ContactEvent::Kept => {
                *unfinished.get_mut(&key).unwrap() -= 1;
                kept.push([contact.ids[0].0, contact.ids[1].0]);
                kept_previous.push(*is_previous);
            }
        }
    }
    assert!(
        unfinished.values().all(|count| *count == 0),
        "{unfinished:?}"
    );
    kept_previous.dedup();
    assert!(kept_previous.len() <= 1);
    let points = contacts.iter().flat_map(|manifold| &manifold.points);
    let mut expected: Vec<_> = points.map(|p| [p.fid1.0, p.fid2.0]).collect();
    kept.sort_unstable();
    expected.sort_unstable();
    assert_eq!(kept, expected);
}

fn at(x: f64, y: f64, z: f64, turn: f64) -> Pose {
    Pose::new(
        Vector::new(x as Real, y as Real, z as Real),
        Vector::new(turn as Real, 0.3 * turn as Real, 0.0),
    )
}

/// What was seen of the events that a scene is there for.
fn saw(events: &[PairEvent], is_it: impl Fn(&ContactEvent) -> bool) -> bool {
    events.iter().any(|event| match event {
        PairEvent::Contact { event, .. } => is_it(event),
        PairEvent::ShellQuery { .. } => false,
    })
}

#[test]
fn each_contact_of_a_body_that_settles_has_one_end() {
    let body = vps(&models::gear(12));
    let cuboid = Cuboid::new(Vector::new(5.0, 0.5, 5.0));
    let other = vps(&Mesh::cuboid([4.0, 1.0, 4.0]).unwrap()).with_role(Role::Both);
    let reach = -f64::from(body.asset().tree.bounds().min.y);
    for ground in [&cuboid as &dyn Shape, &other] {
        let mut contacts = Contacts::new();
        let mut seen = Vec::new();
        for i in 0..30 {
            // Down until it touches, then it turns and stays.
            let height = 0.5 + reach + 0.02 * f64::from((10 - i).max(0)) - 0.002;
            let pose = at(0.1, height, 0.2, 0.03 * f64::from((15 - i).max(0)));
            let events = step(
                VpsDispatcher::default(),
                [ground, &body],
                &pose,
                &mut contacts,
            );
            check(&events, &contacts);
            seen.extend(events);
        }
        assert!(!contacts.is_empty());
        let persist = PairDropReason::PreviousPersist;
        assert!(saw(&seen, |e| *e == ContactEvent::Dropped(persist)));
        let replaced = PairDropReason::PreviousReplaced;
        assert!(saw(&seen, |e| *e == ContactEvent::Dropped(replaced)));
        let tested = seen.iter().filter(|event| {
            let is_test = |e: &Event| matches!(e, Event::PointTested { .. });
            matches!(event, PairEvent::ShellQuery { event, .. } if is_test(event))
        });
        assert!(tested.count() > 30);
    }
}

#[test]
fn turned_normals_and_opposed_and_reduced_contacts_are_told() {
    let box_on_edge = vps(&Mesh::cuboid([1.0; 3]).unwrap());
    let table = Cuboid::new(Vector::new(1.0, 0.5, 1.0));
    // The body's face overhangs an edge of the table.
    let pose = at(1.2, 0.995, 0.0, 0.0);
    let mut contacts = Contacts::new();
    let dispatcher = VpsDispatcher::default();
    let overhang = step(dispatcher, [&table, &box_on_edge], &pose, &mut contacts);
    check(&overhang, &contacts);
    // Deep inside of each other.
    let knot = vps(&models::trefoil_knot(32));
    let mut seen = overhang;
    for i in 0..8 {
        let pose = at(0.05 * f64::from(i), 0.1, 0.0, 0.4 * f64::from(i));
        let mut contacts = Contacts::new();
        let events = step(dispatcher, [&knot, &knot], &pose, &mut contacts);
        check(&events, &contacts);
        seen.extend(events);
    }
    let turned = |reason| move |event: &ContactEvent| matches!(event, ContactEvent::NormalTurned { reason: r, .. } if *r == reason);
    assert!(saw(&seen, turned(TurnReason::Resolved)));
    assert!(saw(&seen, turned(TurnReason::DeepPenetration)));
    let opposed = ContactEvent::Dropped(PairDropReason::Opposed);
    assert!(saw(&seen, |event| *event == opposed));
    // Two shells give more contacts than a pair may have.
    let is_reduced =
        |e: &ContactEvent| matches!(e, ContactEvent::Dropped(PairDropReason::Reduced(_)));
    assert!(saw(&seen, is_reduced));
}

#[test]
fn segments_are_observed_as_well() {
    let body = vps(&models::gear(12));
    let dispatcher = VpsDispatcher {
        manifolds: Manifolds::Segments(3),
        ..VpsDispatcher::default()
    };
    let ground = vps(&Mesh::cuboid([4.0, 1.0, 4.0]).unwrap());
    let mut contacts = Contacts::new();
    let reach = -f64::from(body.asset().tree.bounds().min.y);
    let pose = at(0.0, 0.5 + reach - 0.01, 0.0, 0.0);
    let events = step(dispatcher, [&ground, &body], &pose, &mut contacts);
    check(&events, &contacts);
    assert!(!contacts.is_empty());
    assert!(!saw(&events, |e| matches!(e, ContactEvent::Dropped(_))));
}

#[test]
fn compounds_and_other_pairs_are_unsupported() {
    let body: SharedShape = vps(&Mesh::cuboid([1.0; 3]).unwrap()).into();
    let ball = Ball::new(0.5);
    let compound = Compound::new(vec![(Pose::IDENTITY, body)]);
    let mut contacts = Contacts::new();
    let dispatcher = VpsDispatcher::default();
    let mut ask = |a: &dyn Shape, b: &dyn Shape| {
        let pose = Pose::IDENTITY;
        dispatcher.observe_contact_manifolds(&pose, a, b, 0.0, &mut contacts, &())
    };
    assert!(ask(&compound, &ball).is_err());
    assert!(ask(&ball, &ball).is_err());
}
