//! What is right or wrong about an answer.

/// An answer about a pose, and the truth, in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    /// Of the deepest contact; `None` without a contact.
    pub(super) reported: Option<f64>,
    pub(super) truth: f64,
}

impl Answer {
    /// Reported minus true penetration: negative if it is deeper than reported.
    pub(super) fn error(self) -> Option<f64> {
        self.reported.map(|reported| reported - self.truth)
    }

    fn touches(self) -> bool {
        self.reported.is_some_and(|penetration| penetration >= 0.0)
    }

    /// The bodies overlap by more than the tolerance, and no touch was found.
    pub(super) fn is_missed(self, tolerance: f64) -> bool {
        self.truth > tolerance && !self.touches()
    }

    /// They are apart by more than the tolerance, and a touch was found.
    pub(super) fn is_false_touch(self, tolerance: f64) -> bool {
        self.truth < -tolerance && self.touches()
    }

    /// They are closer than the prediction by more than the tolerance, and no contact was given.
    pub(super) fn is_silent(self, prediction: f64, tolerance: f64) -> bool {
        self.truth > tolerance - prediction && self.reported.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_the_sign_of_what_is_reported_too_deep() {
        let answer = |reported, truth| Answer { reported, truth };
        assert_eq!(answer(Some(3.0), 1.0).error(), Some(2.0));
        assert_eq!(answer(Some(-3.0), -1.0).error(), Some(-2.0));
        assert_eq!(answer(None, 1.0).error(), None);
    }

    #[test]
    fn an_overlap_without_a_touch_is_missed() {
        let is_missed = |reported, truth| Answer { reported, truth }.is_missed(0.1);
        assert!(is_missed(None, 0.2) && is_missed(Some(-0.01), 0.2));
        assert!(!is_missed(Some(0.0), 0.2) && !is_missed(None, 0.1) && !is_missed(None, -5.0));
        let is_false = |reported, truth| Answer { reported, truth }.is_false_touch(0.1);
        assert!(is_false(Some(0.0), -0.2));
        assert!(!is_false(Some(0.0), -0.1) && !is_false(None, -0.2));
        assert!(!is_false(Some(-0.01), -0.2));
    }

    #[test]
    fn what_is_near_needs_a_contact() {
        let is_silent = |reported, truth| Answer { reported, truth }.is_silent(2.0, 0.1);
        assert!(is_silent(None, -1.8) && is_silent(None, 1.0));
        assert!(!is_silent(None, -1.95) && !is_silent(Some(-1.0), -1.8));
    }
}
