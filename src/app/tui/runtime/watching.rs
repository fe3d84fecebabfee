//! Watches files, off the loop: looking through directories takes what a disk takes, and on a network
//! that is gone it takes for ever.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::Happening;
use crate::config::Complaint;
use crate::config::watch::Watch;
use crate::jobs::THREAD_PREFIX;
use crate::tui::update::Msg;

/// The thread that watches, and what it was told last.
pub struct Watching {
    orders: Sender<Order>,
    files: Vec<PathBuf>,
}

enum Order {
    /// This directory from now on, or none.
    Directory(Option<PathBuf>),
    /// These files too, instead of those before.
    Files(Vec<PathBuf>),
}

impl Watching {
    /// Starts the thread, which watches nothing yet.
    pub fn start(sender: &Sender<Happening>) -> std::io::Result<Self> {
        let (orders, received) = channel();
        let sender = sender.clone();
        let thread = std::thread::Builder::new().name(format!("{THREAD_PREFIX}watch"));
        thread.spawn(move || follow(&received, &sender))?;
        Ok(Self { orders, files: Vec::new() })
    }

    /// Watches a directory instead of the one before.
    pub fn directory(&mut self, directory: Option<PathBuf>) {
        // The thread is there until this is dropped.
        let _ = self.orders.send(Order::Directory(directory));
    }

    /// Watches these files too, instead of those before.
    pub fn files(&mut self, files: Vec<PathBuf>) {
        if files != self.files {
            self.files.clone_from(&files);
            let _ = self.orders.send(Order::Files(files));
        }
    }
}

fn follow(orders: &Receiver<Order>, sender: &Sender<Happening>) {
    let mut watch: Option<Watch> = None;
    let mut files: Vec<PathBuf> = Vec::new();
    for order in orders {
        let mut complaints = Vec::new();
        match order {
            Order::Directory(directory) => {
                watch = directory.map(|directory| {
                    let to_loop = sender.clone();
                    let (watch, told) = Watch::new(&[directory], move |changed| {
                        // The loop is deaf only when the program ends.
                        drop(to_loop.send(Happening::Msg(Box::new(Msg::Changed(changed)))));
                    });
                    complaints.extend(told);
                    complaints.extend(watch.also(&files));
                    watch
                });
            }
            Order::Files(wanted) => {
                files = wanted;
                complaints.extend(watch.iter().flat_map(|watch| watch.also(&files)));
            }
        }
        if !complaints.is_empty() {
            let said = complaints.iter().map(Complaint::to_string).collect();
            drop(sender.send(Happening::Msg(Box::new(Msg::Complaints(said)))));
        }
    }
}
